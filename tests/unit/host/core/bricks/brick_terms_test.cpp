#include "host/core/bricks/brick_terms.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <random>
#include <string>
#include <vector>

#include "tests/support/instruction_sets.hpp"

namespace octoskin {
namespace {

constexpr ClampedTerm kMiss{.log_odds = -0.4F, .min = -2.0F, .max = 3.5F};

/// The bits of each: a NaN equals itself then.
std::array<std::uint32_t, kBrickVoxels> bits_of(const BrickValues& values) {
    std::array<std::uint32_t, kBrickVoxels> bits{};
    std::ranges::transform(values, bits.begin(),
                           [](float value) { return std::bit_cast<std::uint32_t>(value); });
    return bits;
}

TEST(BrickTerms, add_what_one_voxel_after_the_other_would_get_on_every_instruction_set) {
    on_each_instruction_set([](const std::string& name) {
        std::mt19937_64 random(7);
        std::uniform_real_distribution<float> any(-2.5F, 4.0F);
        for (int round = 0; round < 60; ++round) {
            BrickValues values;
            for (float& value : values) value = random() % 3 == 0 ? kUnknownLogOdds : any(random);
            BrickMask mask;
            for (std::uint64_t& word : mask) word = round % 4 == 0 ? 0 : random() & (random() | random());
            const ClampedTerm term{round % 2 == 0 ? -0.4F : 0.7F, -2.0F, 3.5F};
            BrickValues expected = values;
            std::size_t unknown = 0;
            for (std::size_t cell = 0; cell < kBrickVoxels; ++cell) {
                if ((mask[cell / 64] >> (cell % 64) & 1U) == 0) continue;
                unknown += std::isnan(values[cell]) ? 1U : 0U;
                const float before = std::isnan(values[cell]) ? 0.0F : values[cell];
                expected[cell] = std::clamp(before + term.log_odds, -2.0F, 3.5F);
            }
            ASSERT_EQ(add_to_voxels(values, mask, term), unknown) << name << " round " << round;
            ASSERT_EQ(bits_of(values), bits_of(expected)) << name << " round " << round;
        }
    });
}

TEST(BrickTerms, go_to_each_voxel_in_turn_though_it_comes_twice) {
    on_each_instruction_set([](const std::string& name) {
        std::mt19937_64 random(8);
        BrickValues values;
        for (float& value : values) value = random() % 3 == 0 ? kUnknownLogOdds : -1.7F;
        BrickValues expected = values;
        std::vector<float*> voxels;
        std::vector<CellTerm> cells;
        std::size_t unknown = 0;
        for (int i = 0; i < 200; ++i) {
            const std::size_t cell = random() % 100;
            const ClampedTerm term{random() % 3 == 0 ? 0.9F : -0.4F, -2.0F, 3.5F};
            voxels.push_back(&values[cell]);
            cells.push_back({0, term.log_odds});
            unknown += std::isnan(expected[cell]) ? 1U : 0U;
            expected[cell] = term.added_to(expected[cell]);
        }
        EXPECT_EQ(add_to_each(voxels, cells, kMiss), unknown) << name;
        EXPECT_EQ(bits_of(values), bits_of(expected)) << name;
    });
}

TEST(BrickTerms, of_one_voxel_begin_at_zero_and_are_clamped) {
    EXPECT_EQ(kMiss.added_to(kUnknownLogOdds), -0.4F);
    EXPECT_EQ(kMiss.added_to(-1.9F), -2.0F);
    EXPECT_EQ((ClampedTerm{1.0F, -2.0F, 3.5F}).added_to(3.0F), 3.5F);
}

TEST(BrickTerms, find_the_one_voxel_that_is_unlike_the_others) {
    on_each_instruction_set([](const std::string& name) {
        BrickValues values;
        values.fill(-2.0F);
        EXPECT_TRUE(are_alike(values)) << name;
        for (std::size_t cell = 0; cell < kBrickVoxels; ++cell) {
            for (const float other : {-1.9F, kUnknownLogOdds}) {
                values[cell] = other;
                ASSERT_FALSE(are_alike(values)) << name << " cell " << cell;
            }
            values[cell] = -2.0F;
        }
        values.fill(kUnknownLogOdds);
        EXPECT_FALSE(are_alike(values)) << "unknown voxels are not known to be alike";
    });
}

}  // namespace
}  // namespace octoskin
