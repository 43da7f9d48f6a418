#include <gtest/gtest.h>

#include "hw/sim/clock.hpp"

namespace octoskin::sim {
namespace {

TEST(NodeClock, starts_at_its_own_value_and_keeps_pace) {
    const NodeClock clock(NodeTime{1'000}, 0.0);
    EXPECT_EQ(clock.to_node({0}).us, 1'000U);
    EXPECT_EQ(clock.to_node({123'456'789}).us, 123'457'789U);
}

TEST(NodeClock, drifts_by_parts_per_million) {
    EXPECT_EQ(NodeClock(NodeTime{0}, 100.0).to_node({10'000'000}).us, 10'001'000U);
    EXPECT_EQ(NodeClock(NodeTime{0}, -100.0).to_node({10'000'000}).us, 9'999'000U);
}

TEST(NodeClock, wraps_at_2_to_the_32) {
    const NodeClock clock(NodeTime{4'294'967'290U}, 0.0);
    EXPECT_EQ(clock.to_node({5}).us, 4'294'967'295U);
    EXPECT_EQ(clock.to_node({6}).us, 0U);
    EXPECT_EQ(clock.to_node({1'000'006}).us, 1'000'000U);
}

TEST(NodeClock, never_runs_backwards) {
    const NodeClock clock(NodeTime{0}, -73.5);
    for (std::int64_t us = 0; us < 100'000; ++us) {
        ASSERT_GE(elapsed(clock.to_node({us}), clock.to_node({us + 1})).count(), 0) << us;
    }
}

}  // namespace
}  // namespace octoskin::sim
