// Noise: repeatable, and distributed as it says. Oracles: the moments and tail weights of the normal
// distribution, and an implementation of the same formula in Python that gives SplitMix64's published first
// output for seed 1234567.
#include "hw/sim/noise/noise.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

namespace octoskin::sim {
namespace {

constexpr int kDraws = 1'000'000;

TEST(Noise, is_the_same_for_equal_seed_source_member_and_index) {
    const Noise once = Noise(42, NoiseSource::depth).of(7);
    const Noise again = Noise(42, NoiseSource::depth).of(7);
    for (std::uint64_t i = 0; i < 1000; ++i) {
        EXPECT_EQ(once.gaussian(i), again.gaussian(i));
    }
    // Recorded values: a change of these changes every seeded result.
    EXPECT_EQ(Noise(0, NoiseSource::depth).bits(0), 0xbfef8030ddc2d772U);
    EXPECT_EQ(Noise(1, NoiseSource::range).of(3).bits(5), 0x4bcb4fdfbe8213e3U);
}

TEST(Noise, differs_between_seeds_sources_members_and_indices) {
    std::set<std::uint64_t> seen;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        for (const auto source : {NoiseSource::depth, NoiseSource::range, NoiseSource::map_shift}) {
            for (std::uint64_t member = 0; member < 20; ++member) {
                for (std::uint64_t index = 0; index < 20; ++index) {
                    seen.insert(Noise(seed, source).of(member).bits(index));
                }
            }
        }
    }
    EXPECT_EQ(seen.size(), 20u * 3u * 20u * 20u);
}

TEST(Noise, gaussian_has_the_moments_and_tails_of_the_normal_distribution) {
    const Noise noise(5, NoiseSource::range);
    double sum = 0.0, squares = 0.0, cubes = 0.0, fourths = 0.0;
    int beyond_one = 0, beyond_three = 0;
    for (int i = 0; i < kDraws; ++i) {
        const double x = noise.gaussian(static_cast<std::uint64_t>(i));
        sum += x;
        squares += x * x;
        cubes += x * x * x;
        fourths += x * x * x * x;
        beyond_one += std::abs(x) > 1.0 ? 1 : 0;
        beyond_three += std::abs(x) > 3.0 ? 1 : 0;
    }
    // Each within five standard errors.
    EXPECT_NEAR(sum / kDraws, 0.0, 5e-3);
    EXPECT_NEAR(squares / kDraws, 1.0, 7.1e-3);
    EXPECT_NEAR(cubes / kDraws, 0.0, 2e-2);
    EXPECT_NEAR(fourths / kDraws, 3.0, 5e-2);
    EXPECT_NEAR(beyond_one / static_cast<double>(kDraws), 0.317311, 2.4e-3);
    EXPECT_NEAR(beyond_three / static_cast<double>(kDraws), 0.0026998, 2.6e-4);
}

TEST(Noise, gaussian_is_uncorrelated_between_neighbours_in_index_and_member) {
    const Noise noise(6, NoiseSource::depth);
    double by_index = 0.0, by_member = 0.0;
    for (std::uint64_t i = 0; i < 200'000; ++i) {
        by_index += noise.gaussian(i) * noise.gaussian(i + 1);
        by_member += noise.of(i).gaussian(3) * noise.of(i + 1).gaussian(3);
    }
    EXPECT_NEAR(by_index / 200'000, 0.0, 0.0112);
    EXPECT_NEAR(by_member / 200'000, 0.0, 0.0112);
}

TEST(Noise, uniform_stays_strictly_between_0_and_1_and_fills_it_evenly) {
    const Noise noise(7, NoiseSource::map_shift);
    std::vector<int> counts(10, 0);
    for (int i = 0; i < 100'000; ++i) {
        const double x = noise.uniform(static_cast<std::uint64_t>(i));
        ASSERT_GT(x, 0.0);
        ASSERT_LT(x, 1.0);
        ++counts[static_cast<std::size_t>(x * 10.0)];
    }
    for (const int count : counts) {
        EXPECT_NEAR(count, 10'000, 475);  // five standard errors
    }
}

}  // namespace
}  // namespace octoskin::sim
