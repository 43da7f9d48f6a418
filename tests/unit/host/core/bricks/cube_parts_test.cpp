#include "host/core/bricks/cube_parts.hpp"

#include <gtest/gtest.h>

#include <random>

#include "host/core/voxels/morton.hpp"

namespace octoskin {
namespace {

TEST(CubeParts, are_in_morton_order) {
    const VoxelCube cube{{32768, 32832, 64}, 6};
    for (MortonCode i = 0; i < 64; ++i) {
        const VoxelCube part = part_of(cube, i);
        EXPECT_EQ(part.height, 4U);
        EXPECT_EQ(morton_of(part.lowest), morton_of(cube.lowest) + (i << 12U));
    }
}

TEST(CubeParts, in_a_box_are_those_that_meet_it) {
    std::mt19937 random(3);
    const auto near = [&](unsigned height) {
        return static_cast<std::uint16_t>(1024 - (1U << height) + random() % (3U << height));
    };
    for (int round = 0; round < 3000; ++round) {
        const unsigned height = round % 2 == 0 ? 2 : 5;
        const VoxelCube cube{{1024, 1024, 1024}, height};
        KeyBox box{{near(height), near(height), near(height)}, {}};
        box.highest = box.lowest;
        box.include({near(height), near(height), near(height)});
        std::uint64_t expected = 0;
        for (std::size_t i = 0; i < 64; ++i) {
            if (do_meet(part_of(cube, i), box)) expected |= std::uint64_t{1} << i;
        }
        ASSERT_EQ(parts_in(cube, box), expected) << round;
    }
}

TEST(CubeParts, reach_the_octrees_ends) {
    const KeyBox all{{0, 0, 0}, {65535, 65535, 65535}};
    EXPECT_EQ(parts_in({{0, 0, 0}, 16}, all), ~std::uint64_t{0});
    EXPECT_EQ(parts_in({{0, 0, 0}, 17}, all), 0xFFU) << "half as wide in each direction";
    EXPECT_EQ(parts_in({{65532, 65532, 65532}, 2}, {{65535, 65535, 65535}, {65535, 65535, 65535}}),
              std::uint64_t{1} << 63U);
}

TEST(CubeParts, have_those_next_to_them_along_each_axis) {
    constexpr VoxelCube kCube{{0, 0, 0}, 2};  // parts are voxels
    for (std::size_t part = 0; part < 64; ++part) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const auto moved = [&](int by) -> std::uint64_t {
                const VoxelKey key = part_of(kCube, part).lowest;
                std::array<int, 3> at{key.x, key.y, key.z};
                at[axis] += by;
                if (at[axis] < 0 || at[axis] > 3) return 0;
                const auto along = [&](std::size_t a) { return static_cast<std::uint16_t>(at[a]); };
                return std::uint64_t{1} << morton_of({along(0), along(1), along(2)});
            };
            EXPECT_EQ(parts_after(std::uint64_t{1} << part, axis), moved(1)) << part;
            EXPECT_EQ(parts_before(std::uint64_t{1} << part, axis), moved(-1)) << part;
        }
    }
    EXPECT_EQ(parts_after(~std::uint64_t{0}, 0), kOddParts[0] | kUpperParts[0]);
}

}  // namespace
}  // namespace octoskin
