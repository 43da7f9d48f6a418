#include "host/apps/daemon/latency.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace octoskin {
namespace {

TEST(LatencyHistogram, is_zero_while_empty) {
    EXPECT_EQ(LatencyHistogram().within(0.5), Nanoseconds{0});
}

TEST(LatencyHistogram, tells_every_share_to_a_step_of_what_sorting_tells) {
    std::mt19937 random(5);
    std::exponential_distribution<double> draw(1.0 / 400e3);
    LatencyHistogram histogram;
    std::vector<Nanoseconds> all;
    for (int i = 0; i < 10'000; ++i) {
        all.emplace_back(static_cast<std::int64_t>(draw(random)));
        histogram.add(all.back());
    }
    std::ranges::sort(all);
    for (const double share : {0.01, 0.5, 0.9, 0.99, 0.999}) {
        const Nanoseconds exact = all[static_cast<std::size_t>(share * 10'000) - 1];
        EXPECT_GE(histogram.within(share), exact) << share;
        EXPECT_LE(histogram.within(share), exact + LatencyHistogram::kStep) << share;
    }
    EXPECT_EQ(histogram.longest(), all.back());
    EXPECT_EQ(histogram.count(), 10'000U);
}

TEST(LatencyHistogram, keeps_what_is_beyond_its_steps_as_the_longest) {
    LatencyHistogram histogram;
    histogram.add(Nanoseconds{7'000'000'000});
    histogram.add(Nanoseconds{-5});
    histogram.add(Nanoseconds{300'000'000});  // a reading that waited for an image
    EXPECT_EQ(histogram.within(1.0), Nanoseconds{7'000'000'000});
    EXPECT_EQ(histogram.within(0.6), Nanoseconds{300'000'000} + LatencyHistogram::kStep);
    EXPECT_EQ(histogram.within(0.3), LatencyHistogram::kStep);
}

}  // namespace
}  // namespace octoskin
