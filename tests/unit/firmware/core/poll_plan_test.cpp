#include "firmware/core/poll_plan.hpp"

#include <gtest/gtest.h>

namespace octoskin::node {
namespace {

constexpr Policy kPolicy;

constexpr Microseconds kPeriod{33'000};

TEST(PollPlan, asks_first_just_before_the_data_can_be_ready) {
    const PollPlan plan{400'000, kPolicy};
    // 48 bits at 400 kHz, half as much again, and 20 us for the loop
    EXPECT_EQ(plan.first_poll({{100'000}, {100'300}}), NodeTime{100'000 - 180 - 20});
}

TEST(PollPlan, lets_a_line_go_first_and_asks_just_after_the_data_must_be_ready) {
    const PollPlan plan{400'000, kPolicy};
    EXPECT_EQ(plan.poll_after_hint({{100'000}, {100'300}}), NodeTime{100'350});
}

TEST(PollPlan, asks_again_halfway_to_the_latest_time_it_can_be) {
    const PollPlan plan{400'000, kPolicy};
    const TimeBracket predicted{{100'000}, {101'000}};
    EXPECT_EQ(plan.repoll(predicted, kPeriod, {100'000}), NodeTime{100'500});
    EXPECT_EQ(plan.repoll(predicted, kPeriod, {100'990}), NodeTime{101'040});  // never below 50 us
}

TEST(PollPlan, asks_ever_more_rarely_the_longer_the_data_is_overdue) {
    const PollPlan plan{400'000, kPolicy};
    const TimeBracket predicted{{100'000}, {101'000}};
    EXPECT_EQ(plan.repoll(predicted, kPeriod, {101'300}), NodeTime{101'600});
    EXPECT_EQ(plan.repoll(predicted, kPeriod, {120'000}), NodeTime{121'000});  // never above 1 ms
}

TEST(PollPlan, looks_in_the_middle_of_where_the_ready_time_must_be) {
    const PollPlan plan{400'000, kPolicy};
    const NodeTime due = plan.poll_in_middle({{100'000}, {100'300}});
    EXPECT_EQ(plan.not_ready_until(due), NodeTime{100'150});
}

TEST(PollPlan, asks_every_millisecond_while_nothing_is_known_however_long_the_polls_take) {
    const PollPlan plan{400'000, kPolicy};
    for (const std::uint32_t now : {5'000U, 5'001U, 5'999U})
        EXPECT_EQ(plan.blind_poll({2'000}, kPeriod, {now}), NodeTime{6'000}) << now;
    EXPECT_EQ(plan.blind_poll({2'000}, kPeriod, {500}), NodeTime{2'000});
    EXPECT_EQ(plan.blind_poll({5'000}, Microseconds{640'000}, {5'000}), NodeTime{10'000});  // period / 128
    EXPECT_EQ(plan.blind_poll({0xFFFFFF00U}, kPeriod, {100}), NodeTime{0xFFFFFF00U} + Microseconds{1'000});
}

TEST(PollPlan, expects_nothing_after_a_start_before_most_of_the_budget_is_used) {
    const PollPlan plan{400'000, kPolicy};
    EXPECT_EQ(plan.first_poll_after_start({1'000}, Microseconds{20'000}), NodeTime{19'000});
}

TEST(PollPlan, counts_not_ready_only_from_when_the_sensor_knew_what_was_asked) {
    const PollPlan plan{400'000, kPolicy};
    EXPECT_EQ(plan.not_ready_until({1'000}), NodeTime{1'070});  // 28 bits at 400 kHz
}

}  // namespace
}  // namespace octoskin::node
