#include "firmware/core/token_bucket.hpp"

#include <gtest/gtest.h>

namespace octoskin::node {
namespace {

/// Frames let through in [0, `seconds`) when asked every 100 us.
int frames_in(TokenBucket bucket, NodeTime start, int seconds) {
    int frames = 0;
    for (int i = 0; i < seconds * 10'000; ++i) {
        bucket.refill(start + Microseconds{i * 100});
        while (bucket.has_token()) {
            bucket.take();
            ++frames;
        }
    }
    return frames;
}

TEST(TokenBucket, lets_a_burst_through_and_then_the_rate) {
    const TokenBucket bucket{{.per_second = 200, .burst = 30}, {0}};
    EXPECT_EQ(frames_in(bucket, {0}, 1), 30 + 199);  // the 200th token is full exactly at the end
    EXPECT_EQ(frames_in(bucket, {0}, 3), 30 + 599);
}

TEST(TokenBucket, works_across_the_wrap_of_the_clock) {
    const NodeTime start{0xFFFFFFFFU - 500'000U};
    EXPECT_EQ(frames_in(TokenBucket{{.per_second = 200, .burst = 30}, start}, start, 1), 30 + 199);
}

TEST(TokenBucket, keeps_one_token_for_what_goes_first_and_tells_how_long_to_wait_for_another) {
    TokenBucket bucket{{.per_second = 100, .burst = 2}, {0}};
    EXPECT_TRUE(bucket.has_spare_token());
    EXPECT_EQ(bucket.wait(), Microseconds{0});
    bucket.take();
    EXPECT_TRUE(bucket.has_token());
    EXPECT_FALSE(bucket.has_spare_token());
    EXPECT_EQ(bucket.wait(), Microseconds{10'000});
    bucket.take();
    EXPECT_FALSE(bucket.has_token());
    EXPECT_EQ(bucket.wait(), Microseconds{20'000});
    bucket.refill({9'999});
    EXPECT_FALSE(bucket.has_token());
    bucket.refill({10'000});
    EXPECT_TRUE(bucket.has_token());
    bucket.refill({19'999});
    EXPECT_FALSE(bucket.has_spare_token());
    bucket.refill({20'000});
    EXPECT_TRUE(bucket.has_spare_token());
}

TEST(FrameBudget, is_twice_the_nominal_rate_in_any_second) {
    NodeConfig config;
    config.uses_can_fd = false;
    config.sensor_count = 17;
    for (auto& sensor : config.sensors) sensor.inter_measurement_ms = 33;
    // 17 * 31 readings, 17 healths, 10 heartbeats, 7 pages, 1 sync report
    const FrameBudget budget = frame_budgets(config).others;
    EXPECT_EQ(frame_budgets(config).reflex, FrameBudget{}) << "nobody watches";
    EXPECT_EQ(budget.per_second + budget.burst, 2U * (17 * 31 + 17 + 10 + 7 + 1));

    config.aux_every = 4;  // 31 / 4 + 1 more for each sensor
    const FrameBudget with_aux = frame_budgets(config).others;
    EXPECT_EQ(with_aux.per_second + with_aux.burst, 2U * (17 * 31 + 17 * 8 + 17 + 10 + 7 + 1));
}

TEST(FrameBudget, has_a_part_for_reflexes_and_at_least_the_nominal_rate_for_the_rest) {
    for (const std::uint16_t period_ms : {std::uint16_t{24}, std::uint16_t{33}, std::uint16_t{1'000}}) {
        for (const std::uint8_t count : {std::uint8_t{1}, std::uint8_t{34}}) {
            NodeConfig config;
            config.sensor_count = count;
            for (auto& sensor : config.sensors) {
                sensor.inter_measurement_ms = period_ms;
                sensor.reflex_below_mm = 100;
            }
            const FrameBudgets budgets = frame_budgets(config);
            const std::uint32_t readings = (1'000U + period_ms - 1) / period_ms * count;
            const std::uint32_t nominal = readings + count + 10 + 7 + 1;
            EXPECT_EQ(budgets.reflex.burst, count) << "each of them at once";
            EXPECT_EQ(budgets.reflex.per_second, (readings + 2) / 3);
            EXPECT_GE(budgets.others.per_second, nominal);
            EXPECT_EQ(budgets.others.per_second + budgets.others.burst + budgets.reflex.per_second +
                          budgets.reflex.burst,
                      2 * nominal);
        }
    }
}

}  // namespace
}  // namespace octoskin::node
