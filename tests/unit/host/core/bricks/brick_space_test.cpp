#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "host/core/bricks/brick_tree.hpp"

namespace octoskin {
namespace {

/// The bricks below `space` that have a known voxel, by their first voxel's code.
void gather(const BrickTree::Space& space, std::map<MortonCode, BrickView>& bricks) {
    if (!space.has_parts()) {
        if (space.bricks().is_unknown()) return;
        EXPECT_EQ(space.cube().height, kBrickHeight);
        bricks[morton_of(space.cube().lowest)] = space.bricks();
        return;
    }
    const std::size_t parts = space.cube().height > 16 ? 8 : 64;
    for (std::size_t i = 0; i < parts; ++i) gather(space.part(i), bricks);
}

TEST(BrickSpace, leads_to_every_brick) {
    BrickTree tree;
    const MortonCode first = 0;
    const MortonCode middle = brick_of({32768, 32760, 1234});
    const MortonCode last = brick_of({65535, 65535, 65535});
    tree.set_all(first, -1.0F);
    tree.open(middle)[77] = 2.0F;
    tree.set_all(last, 3.0F);
    std::map<MortonCode, BrickView> bricks;
    gather(tree.space(), bricks);
    ASSERT_EQ(bricks.size(), 3U);
    EXPECT_EQ(bricks.at(first).at(5), -1.0F);
    EXPECT_EQ(bricks.at(middle).at(77), 2.0F);
    EXPECT_TRUE(std::isnan(bricks.at(middle).at(76)));
    EXPECT_EQ(bricks.at(last).at(511), 3.0F);
}

TEST(BrickSpace, of_an_empty_tree_is_the_octree_and_unknown) {
    const BrickTree tree;
    EXPECT_FALSE(tree.space().has_parts());
    EXPECT_TRUE(tree.space().bricks().is_unknown());
    EXPECT_EQ(tree.space().cube().height, 16U);
}

TEST(BrickSpace, beside_a_brick_is_unknown_in_cubes_as_large_as_can_be) {
    BrickTree tree;
    tree.set_all(0, -1.0F);
    const BrickTree::Space eighth = tree.space().part(1);
    EXPECT_FALSE(eighth.has_parts());
    EXPECT_TRUE(eighth.bricks().is_unknown());
    EXPECT_EQ(eighth.cube().height, 15U);
    EXPECT_EQ(eighth.cube().lowest, (VoxelKey{32768, 0, 0}));
}

}  // namespace
}  // namespace octoskin
