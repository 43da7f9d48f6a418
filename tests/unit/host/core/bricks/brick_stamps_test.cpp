// Every instruction set that this processor has against one voxel at a time.
#include "host/core/bricks/brick_stamps.hpp"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <random>

namespace octoskin {
namespace {

bool contains(const BrickMask& mask, std::size_t cell) {
    return (mask[cell / 64] >> (cell % 64) & 1U) != 0;
}

void expect_as_one_by_one(std::mt19937_64& random) {
    BrickStamps stamps;
    for (std::uint16_t& stamp : stamps) stamp = static_cast<std::uint16_t>(random() % 4 * 0x5555U);
    BrickMask mask;
    for (std::uint64_t& word : mask) word = random() % 3 == 0 ? 0 : random() & random();
    BrickStamps expected = stamps;
    bool has_other = false;
    for (std::size_t cell = 0; cell < kBrickVoxels; ++cell) {
        if (!contains(mask, cell)) continue;
        has_other = has_other || stamps[cell] != 0xAAAA;
        expected[cell] = 0xAAAA;
    }
    EXPECT_EQ(has_other_stamp(stamps, mask, 0xAAAA), has_other);
    for (std::size_t cell = 0; cell < kBrickVoxels; ++cell)
        EXPECT_EQ(stamps_below(stamps, cell / 64, 0xAAAA) >> (cell % 64) & 1U, stamps[cell] < 0xAAAA);
    put_stamp(stamps, mask, 0xAAAA);
    EXPECT_EQ(stamps, expected);
    EXPECT_FALSE(has_other_stamp(stamps, mask, 0xAAAA));
}

TEST(BrickStamps, are_put_and_compared_as_one_voxel_after_the_other) {
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
        hwy::SetSupportedTargetsForTest(target);
        std::mt19937_64 random(5);
        for (int i = 0; i < 50; ++i) expect_as_one_by_one(random);
    }
    hwy::SetSupportedTargetsForTest(0);
}

}  // namespace
}  // namespace octoskin
