// One sender's numbers and times, and what a second one does to them.
#include "host/core/ingest/joint_sender_check.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace octoskin {
namespace {

using Rounds = JointSenderCheck::Rounds;

constexpr double kRateHz = 100.0;

HostTime at_us(std::int64_t us) {
    return HostTime{us * 1'000};
}

class JointSenderCheckTest : public testing::Test {
  protected:
    /// A sample that comes 1 ms after it was taken; its first joint tells whose it is.
    void put(std::uint64_t number, std::int64_t sampled_us, double whose = 0.0) {
        check_.advance(at_us(sampled_us + 1'000), ended_);
        JointMeasurement joints{at_us(sampled_us), {}};
        joints.position_rad[0] = whose;
        check_.on_sample(static_cast<std::uint8_t>(number % 8), joints, at_us(sampled_us + 1'000), ended_);
    }
    void put_honest(std::uint64_t from, std::uint64_t until) {
        for (std::uint64_t n = from; n < until; ++n) put(n, static_cast<std::int64_t>(10'000 * n));
    }
    [[nodiscard]] std::size_t used() const {
        return static_cast<std::size_t>(
            std::ranges::count_if(ended_, [](const auto& one) { return one.has_value(); }));
    }
    [[nodiscard]] std::size_t withheld() const {
        return static_cast<std::size_t>(std::ranges::count_if(ended_, [](const auto& one) {
            return !one.has_value() && one.error() == JointReason::second_sender;
        }));
    }
    void expect_none_of_another() const {
        for (const auto& one : ended_) EXPECT_TRUE(!one || one->position_rad[0] == 0.0) << one->sampled.ns;
    }

    JointSenderCheck check_{kRateHz, true};
    JointSenderCheck::Ended ended_;
};

TEST_F(JointSenderCheckTest, uses_a_sample_a_period_and_a_quarter_after_it_came) {
    put(0, 0);
    put(1, 10'000);
    check_.advance(at_us(1'000 + 12'499), ended_);
    EXPECT_EQ(used(), 0U);
    check_.advance(at_us(1'000 + 12'500), ended_);
    EXPECT_EQ(used(), 1U);
    EXPECT_EQ(check_.waiting(), 1U);
}

TEST_F(JointSenderCheckTest, waits_for_a_successor_for_four_periods) {
    put(0, 0);
    check_.advance(at_us(40'999), ended_);
    EXPECT_EQ(used(), 0U);
    check_.advance(at_us(41'000), ended_);
    EXPECT_EQ(used(), 1U);
}

TEST_F(JointSenderCheckTest, holds_nothing_back_where_nobody_else_can_send) {
    JointSenderCheck local(kRateHz, false);
    local.on_sample(3, {at_us(0), {}}, at_us(0), ended_);
    local.on_sample(3, {at_us(1'000), {}}, at_us(1'000), ended_);
    EXPECT_EQ(used(), 2U);
    EXPECT_EQ(local.waiting(), 0U);
    EXPECT_FALSE(local.hears_two(at_us(1'000)));
}

// Between each two numbers of the node, at each moment, one of every number.
TEST_F(JointSenderCheckTest, uses_none_of_a_second_sender_whatever_its_number_and_time) {
    for (std::uint64_t number = 0; number < 8; ++number) {
        for (std::int64_t after_us = 0; after_us < 10'000; after_us += 500) {
            check_ = JointSenderCheck(kRateHz, true);
            ended_.clear();
            put_honest(0, 100);
            put(number, 990'000 + after_us, 1.0);
            put_honest(100, 130);
            expect_none_of_another();
            EXPECT_EQ(check_.contradictions(), 1U) << number << ' ' << after_us;
            EXPECT_TRUE(check_.hears_two(at_us(1'001'000))) << number << ' ' << after_us;
            put_honest(130, 400);
            EXPECT_LE(withheld(), 104U) << "a second of it";
            EXPECT_FALSE(check_.hears_two(at_us(2'010'000)));
            EXPECT_GT(used(), 294U);
        }
    }
}

TEST_F(JointSenderCheckTest, hears_the_second_one_until_a_second_after_its_last_sample) {
    put_honest(0, 100);
    for (std::uint64_t n = 100; n < 300; ++n) {
        put(n, static_cast<std::int64_t>(10'000 * n) - 4'000, 1.0);  // it always comes first
        put(n, static_cast<std::int64_t>(10'000 * n));
    }
    expect_none_of_another();
    EXPECT_EQ(used(), 99U);
    EXPECT_TRUE(check_.hears_two(at_us(3'990'000)));
    EXPECT_FALSE(check_.hears_two(at_us(3'992'000)));
    put_honest(300, 420);
    EXPECT_GT(used(), 99U + 15U);
    expect_none_of_another();
}

TEST_F(JointSenderCheckTest, takes_a_frame_that_contradicts_a_sample_that_waits_for_a_second_senders) {
    put_honest(0, 10);
    EXPECT_EQ(check_.waiting(), 2U);
    check_.on_contradiction(2, Rounds::any, at_us(92'000), ended_);
    EXPECT_EQ(check_.contradictions(), 0U) << "of one that was used, or is not whole";
    check_.on_contradiction(1, Rounds::any, at_us(92'000), ended_);
    EXPECT_EQ(check_.contradictions(), 1U) << "of number 9";
    EXPECT_EQ(check_.waiting(), 0U);
    EXPECT_EQ(withheld(), 2U);
    check_.on_contradiction(2, Rounds::one, at_us(93'000), ended_);
    EXPECT_EQ(check_.contradictions(), 2U) << "two times of one round";
}

TEST_F(JointSenderCheckTest,
       takes_a_quarter_of_its_samples_in_contradictions_within_a_second_for_a_second_sender) {
    for (int k = 0; k < 100; ++k) check_.on_contradiction(2, Rounds::any, at_us(40'000 * k), ended_);
    EXPECT_EQ(check_.contradictions(), 0U);
    for (int k = 0; k < 26; ++k)
        check_.on_contradiction(2, Rounds::any, at_us(20'000'000 + 39'000 * k), ended_);
    EXPECT_EQ(check_.contradictions(), 1U);
}

TEST_F(JointSenderCheckTest, takes_two_frames_of_no_round_within_a_second_for_a_second_senders) {
    for (int k = 0; k < 10; ++k) check_.on_contradiction(2, Rounds::none, at_us(1'001'000 * k), ended_);
    EXPECT_EQ(check_.contradictions(), 0U);
    check_.on_contradiction(5, Rounds::none, at_us(9'900'000), ended_);
    EXPECT_EQ(check_.contradictions(), 1U);
}

TEST_F(JointSenderCheckTest, is_over_where_time_goes_back) {
    put_honest(0, 10);
    check_.on_contradiction(1, Rounds::any, at_us(95'000), ended_);
    EXPECT_TRUE(check_.hears_two(at_us(94'000)));
    EXPECT_FALSE(check_.hears_two(at_us(-3'600'000'000)));
}

}  // namespace
}  // namespace octoskin
