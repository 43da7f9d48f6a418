#include "host/core/traversal/visited_grid.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace octoskin {
namespace {

using testing::ElementsAre;

/// In Morton order.
std::vector<VoxelKey> drained(VisitedGrid& grid) {
    std::vector<VoxelKey> keys;
    grid.drain([&](MortonCode brick, const BrickMask& passed) {
        for (std::size_t cell = 0; cell < kBrickVoxels; ++cell) {
            if ((passed[cell / 64] >> (cell % 64) & 1U) != 0) keys.push_back(key_of_morton(brick + cell));
        }
    });
    return keys;
}

TEST(VisitedGrid, gives_each_mark_once_in_order_and_is_empty_then) {
    VisitedGrid grid;
    ASSERT_TRUE(grid.span({100, 200, 300}, {110, 203, 309}, 100'000));
    grid.marks()[grid.index_of({109, 201, 300})] = VisitedGrid::kPassed;
    grid.marks()[grid.index_of({110, 200, 300})] = VisitedGrid::kPassed;
    grid.marks()[grid.index_of({99, 204, 310})] = VisitedGrid::kPassed;  // a voxel beside the box
    EXPECT_THAT(drained(grid),
                ElementsAre(VoxelKey{109, 201, 300}, VoxelKey{110, 200, 300}, VoxelKey{99, 204, 310}));
    EXPECT_TRUE(drained(grid).empty());
}

TEST(VisitedGrid, gives_each_voxel_of_a_brick_its_own_place) {
    VisitedGrid grid;
    for (std::size_t cell = 0; cell < kBrickVoxels; ++cell) {
        const VoxelKey key = key_of_morton(morton_of({104, 208, 304}) + cell);
        ASSERT_TRUE(grid.span({104, 208, 304}, {111, 215, 311}, 100'000));
        grid.marks()[grid.index_of(key)] = VisitedGrid::kPassed;
        ASSERT_THAT(drained(grid), ElementsAre(key));
    }
}

TEST(VisitedGrid, leaves_out_what_has_no_key) {
    VisitedGrid grid;
    ASSERT_TRUE(grid.span({0, 0, 65535}, {0, 0, 65535}, 100'000));
    grid.marks()[grid.index_of(-1, 0, 65535)] = VisitedGrid::kPassed;
    grid.marks()[grid.index_of(0, -1, 65535)] = VisitedGrid::kPassed;
    grid.marks()[grid.index_of(0, 0, 65536)] = VisitedGrid::kPassed;
    EXPECT_TRUE(drained(grid).empty());
    grid.marks()[grid.index_of(0, 0, 65535)] = VisitedGrid::kPassed;
    EXPECT_THAT(drained(grid), ElementsAre(VoxelKey{0, 0, 65535}));
}

TEST(VisitedGrid, forgets_marks_that_were_nowhere) {
    VisitedGrid grid;
    ASSERT_TRUE(grid.span({100, 100, 100}, {101, 101, 101}, 100'000));
    grid.marks()[grid.nowhere()] = VisitedGrid::kPassed;
    EXPECT_TRUE(drained(grid).empty());
    ASSERT_TRUE(grid.span({100, 100, 100}, {140, 140, 140}, 1'000'000));
    EXPECT_TRUE(drained(grid).empty());
    ASSERT_TRUE(grid.span({100, 100, 100}, {101, 101, 101}, 100'000));
    grid.marks()[grid.nowhere()] = VisitedGrid::kPassed;
    EXPECT_TRUE(drained(grid).empty());
    ASSERT_TRUE(grid.span({100, 100, 100}, {110, 110, 110}, 1'000'000));
    EXPECT_TRUE(drained(grid).empty());
}

TEST(VisitedGrid, refuses_a_box_that_is_too_large) {
    VisitedGrid grid;
    EXPECT_FALSE(grid.span({0, 0, 0}, {65535, 65535, 65535}, std::size_t{1} << 30U));
    EXPECT_FALSE(grid.span({100, 100, 100}, {100, 100, 100}, 511));
    EXPECT_TRUE(grid.span({100, 100, 100}, {100, 100, 100}, 512));
}

}  // namespace
}  // namespace octoskin
