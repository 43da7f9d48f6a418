#include "host/core/bricks/brick_walk.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace octoskin {
namespace {

std::vector<MortonCode> walked(const KeyBox& box) {
    std::vector<MortonCode> bricks;
    walk_bricks(
        box, [](const VoxelCube&) { return CubeCoverage::some; },
        [&](MortonCode brick, bool is_all) {
            EXPECT_FALSE(is_all);
            bricks.push_back(brick);
        });
    return bricks;
}

TEST(BrickWalk, visits_each_brick_of_the_box_once_in_morton_order) {
    const KeyBox box{{32760, 32767, 5}, {32769, 32790, 12}};  // 2 x 4 x 2 bricks, about the octree's middle
    const auto bricks = walked(box);
    EXPECT_EQ(bricks.size(), 16U);
    EXPECT_TRUE(std::ranges::is_sorted(bricks));
    for (const MortonCode brick : bricks) EXPECT_TRUE(do_meet({key_of_morton(brick), kBrickHeight}, box));
    EXPECT_EQ(std::ranges::adjacent_find(bricks), bricks.end());
}

TEST(BrickWalk, reaches_the_octrees_corners) {
    EXPECT_EQ(walked({{0, 0, 0}, {0, 0, 0}}), std::vector<MortonCode>{0});
    EXPECT_EQ(walked({{65535, 65535, 65535}, {65535, 65535, 65535}}),
              std::vector<MortonCode>{(MortonCode{1} << 48U) - kBrickVoxels});
}

TEST(BrickWalk, asks_nothing_below_a_cube_that_has_none_or_all) {
    const KeyBox box{{1024, 1024, 1024}, {1024 + 63, 1024 + 63, 1024 + 63}};
    std::size_t asked = 0;
    std::size_t visited = 0;
    walk_bricks(
        box,
        [&](const VoxelCube& cube) {
            ++asked;
            if (cube.height > 5) return CubeCoverage::some;
            return cube.lowest.x < 1024 + 32 ? CubeCoverage::none : CubeCoverage::all;
        },
        [&](MortonCode brick, bool is_all) {
            ++visited;
            EXPECT_TRUE(is_all);
            EXPECT_GE(key_of_morton(brick).x, 1024 + 32);
        });
    EXPECT_EQ(visited, 4U * 64);
    EXPECT_LE(asked, 8U + 4U);  // the box is one cube of height 6; those above it hold it
}

}  // namespace
}  // namespace octoskin
