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
    const FrameBudget budget = frame_budget(config);
    EXPECT_EQ(budget.per_second + budget.burst, 2U * (17 * 31 + 17 + 10 + 7 + 1));

    config.aux_every = 4;  // 31 / 4 + 1 more for each sensor
    const FrameBudget with_aux = frame_budget(config);
    EXPECT_EQ(with_aux.per_second + with_aux.burst, 2U * (17 * 31 + 17 * 8 + 17 + 10 + 7 + 1));
}

}  // namespace
}  // namespace octoskin::node
