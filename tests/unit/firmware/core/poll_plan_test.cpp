#include "firmware/core/poll_plan.hpp"

#include <gtest/gtest.h>

namespace octoskin::node {
namespace {

constexpr Policy kPolicy;

constexpr Microseconds kPeriod{33'000};

TEST(PollPlan, asks_first_just_before_the_data_can_be_ready) {
    const PollPlan plan{400'000, kPolicy};
    // 48 bits at 400 kHz, a quarter more, and 20 us for the loop
    EXPECT_EQ(plan.first_poll({{100'000}, {100'300}}), NodeTime{100'000 - 150 - 20});
}

TEST(PollPlan, lets_a_line_go_first_and_asks_just_after_the_data_must_be_ready) {
    const PollPlan plan{400'000, kPolicy};
    EXPECT_EQ(plan.poll_after_hint({{100'000}, {100'300}}), NodeTime{100'320});
}

TEST(PollPlan, asks_again_at_once_while_the_data_may_become_ready) {
    const PollPlan plan{400'000, kPolicy};
    const TimeBracket predicted{{100'000}, {101'000}};
    EXPECT_EQ(plan.repoll(predicted, kPeriod, {100'000}), NodeTime{100'020});
    EXPECT_EQ(plan.repoll(predicted, kPeriod, {100'990}), NodeTime{101'010});
}

TEST(PollPlan, leaves_a_slow_sensor_more_time_between_two_polls) {
    const PollPlan plan{400'000, kPolicy};
    const Microseconds period{1'024'000};
    const TimeBracket predicted{{100'000}, {110'000}};
    EXPECT_EQ(plan.repoll(predicted, period, {100'000}), NodeTime{100'500});  // period / 2048
    EXPECT_EQ(plan.repoll(predicted, period, {109'400}), NodeTime{109'700});  // halfway to the latest time
}

TEST(PollPlan, asks_ever_more_rarely_the_longer_the_data_is_overdue) {
    const PollPlan plan{400'000, kPolicy};
    const TimeBracket predicted{{100'000}, {101'000}};
    EXPECT_EQ(plan.repoll(predicted, kPeriod, {101'300}), NodeTime{101'600});
    EXPECT_EQ(plan.repoll(predicted, kPeriod, {120'000}), NodeTime{121'000});  // never above 1 ms
}

TEST(PollPlan, looks_in_the_middle_of_where_the_ready_time_must_be) {
    const PollPlan plan{400'000, kPolicy};
    const NodeTime due = plan.poll_within({{100'000}, {100'260}}, kPeriod);
    EXPECT_EQ(plan.not_ready_until(due), NodeTime{100'130});
}

TEST(PollPlan, looks_in_up_to_four_places_where_the_ready_time_is_known_less_well) {
    const PollPlan plan{400'000, kPolicy};
    // The time of a poll, or a quarter of what is not known.
    EXPECT_EQ(plan.not_ready_until(plan.poll_within({{100'000}, {100'500}}, kPeriod)), NodeTime{100'136});
    EXPECT_EQ(plan.not_ready_until(plan.poll_within({{100'000}, {101'000}}, kPeriod)), NodeTime{100'250});
}

TEST(PollPlan, asks_every_millisecond_while_nothing_is_known_however_long_the_polls_take) {
    const PollPlan plan{400'000, kPolicy};
    for (const std::uint32_t now : {5'000U, 5'001U, 5'999U})
        EXPECT_EQ(plan.blind_poll({2'000}, kPeriod, {now}), NodeTime{6'000}) << now;
    EXPECT_EQ(plan.blind_poll({2'000}, kPeriod, {500}), NodeTime{2'000});
    EXPECT_EQ(plan.blind_poll({5'000}, Microseconds{640'000}, {5'000}), NodeTime{10'000});  // period / 128
    EXPECT_EQ(plan.blind_poll({0xFFFFFF00U}, kPeriod, {100}), NodeTime{0xFFFFFF00U} + Microseconds{1'000});
}

TEST(PollPlan, asks_again_and_again_where_the_first_data_of_a_run_is_expected) {
    const PollPlan plan{400'000, kPolicy};
    const TimeBracket expected{{30'360}, {35'640}};
    const auto next = [&](const TimeBracket& asked) {
        return plan.poll_after_start({18'000}, expected, kPeriod, asked);
    };
    EXPECT_EQ(next({{4'900}, {5'000}}), NodeTime{18'000});
    EXPECT_EQ(next({{17'900}, {18'001}}), NodeTime{19'000});
    EXPECT_EQ(next({{30'000}, {30'100}}), NodeTime{30'360});
    for (const std::uint32_t now : {30'397U, 30'450U, 30'529U})
        EXPECT_EQ(next({{30'360}, {now}}), NodeTime{30'530}) << now;
    EXPECT_EQ(next({{34'950}, {35'072}}), NodeTime{35'120});
    EXPECT_EQ(next({{35'460}, {35'640}}), NodeTime{36'640});
}

TEST(PollPlan, asks_at_once_for_each_place_that_it_missed_however_late_it_is) {
    const PollPlan plan{400'000, kPolicy};
    const auto next = [&](const TimeBracket& asked) {
        return plan.poll_after_start({18'000}, {{30'360}, {35'640}}, kPeriod, asked);
    };
    for (const std::uint32_t now : {30'360U, 30'396U, 30'397U, 30'529U})
        EXPECT_EQ(next({{30'359}, {now}}), NodeTime{30'360}) << now;
    EXPECT_EQ(next({{30'360}, {30'530}}), NodeTime{30'530}) << "missed by nothing";
    EXPECT_EQ(next({{30'360}, {30'699}}), NodeTime{30'530});
    EXPECT_EQ(next({{30'360}, {31'000}}), NodeTime{30'870}) << "the last of several";
    EXPECT_EQ(next({{30'600}, {30'699}}), NodeTime{30'700}) << "that one was asked, late";
}

TEST(PollPlan, expects_nothing_after_a_start_before_most_of_the_budget_is_used) {
    const PollPlan plan{400'000, kPolicy};
    EXPECT_EQ(plan.first_poll_after_start({1'000}, Microseconds{20'000}), NodeTime{19'000});
}

TEST(PollPlan, counts_not_ready_only_from_when_the_sensor_knew_what_was_asked) {
    const PollPlan plan{400'000, kPolicy};
    EXPECT_EQ(plan.not_ready_until({1'000}), NodeTime{1'070});  // 28 bits at 400 kHz
    EXPECT_EQ(plan.ready_by({1'000}), NodeTime{975});           // 10 bits
}

}  // namespace
}  // namespace octoskin::node
