// How long a node that went bus-off keeps off the bus.
#include "firmware/core/bus_off_recovery.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace octoskin::node {
namespace {

using Action = BusOffRecovery::Action;

constexpr std::int64_t kStepUs = 100;
// Across the wrap of the clock.
constexpr NodeTime kStart{0xFFFF'FFFFU - 1'000'000U};

class BusOffRecoveryTest : public testing::Test {
  protected:
    /// Runs in the given state until an action comes; returns after how long, or -1.
    std::int64_t until_action(CanState state, Action expected, std::int64_t within_us = 10'000'000) {
        for (std::int64_t waited = 0; waited <= within_us; waited += kStepUs) {
            const Action action = recovery_.update(state, now_);
            if (action != Action::none) {
                EXPECT_EQ(action, expected);
                return waited;
            }
            now_ = now_ + Microseconds{kStepUs};
        }
        return -1;
    }
    const Policy policy_{};
    BusOffRecovery recovery_{policy_};
    NodeTime now_ = kStart;
};

TEST_F(BusOffRecoveryTest, does_nothing_while_the_controller_is_on_the_bus) {
    EXPECT_EQ(until_action(CanState::active, Action::none), -1);
    EXPECT_EQ(until_action(CanState::passive, Action::none), -1);
    EXPECT_FALSE(recovery_.is_recent());
    EXPECT_EQ(recovery_.count(), 0U);
    EXPECT_FALSE(recovery_.wake_time());
}

TEST_F(BusOffRecoveryTest, gives_up_what_waits_at_once_and_tries_after_100_200_400_and_800_ms) {
    EXPECT_EQ(until_action(CanState::bus_off, Action::discard), 0);
    for (const std::int64_t ms : {100, 200, 400, 800, 800, 800}) {
        EXPECT_EQ(*recovery_.wake_time(), now_ + Microseconds{ms * 1'000});
        EXPECT_EQ(until_action(CanState::bus_off, Action::restart), ms * 1'000);
    }
    EXPECT_EQ(recovery_.count(), 1U);
}

TEST_F(BusOffRecoveryTest, doubles_too_if_it_came_back_for_less_than_a_second) {
    for (const std::int64_t ms : {100, 200, 400, 800, 800}) {
        EXPECT_EQ(until_action(CanState::bus_off, Action::discard), 0);
        EXPECT_EQ(until_action(CanState::bus_off, Action::restart), ms * 1'000);
        EXPECT_EQ(until_action(CanState::active, Action::resume), 0);
        EXPECT_EQ(until_action(CanState::active, Action::none, 999'000), -1);
        EXPECT_TRUE(recovery_.is_recent());
    }
    EXPECT_EQ(recovery_.count(), 5U);
}

TEST_F(BusOffRecoveryTest, begins_anew_after_a_second_on_the_bus) {
    for (int i = 0; i < 3; ++i) {
        EXPECT_EQ(until_action(CanState::bus_off, Action::discard), 0);
        EXPECT_EQ(until_action(CanState::bus_off, Action::restart), 100'000);
        EXPECT_EQ(until_action(CanState::passive, Action::resume), 0);
        EXPECT_EQ(until_action(CanState::active, Action::none, 1'000'100), -1);
        EXPECT_FALSE(recovery_.is_recent());
    }
}

}  // namespace
}  // namespace octoskin::node
