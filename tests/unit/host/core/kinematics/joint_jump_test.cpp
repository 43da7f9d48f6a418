// What is a jump, which of two tracks is used, and that no track is shut out for ever.
#include "host/core/kinematics/joint_jump.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace octoskin {
namespace {

using SampleFit = JointJump::SampleFit;

/// A joint of 2 rad/s and one of 0.5 m/s.
constexpr std::array<JointLimits, 2> kLimits = {JointLimits{-3.0, 3.0, 2.0}, JointLimits{-3.0, 3.0, 0.5}};

HostTime at_ms(std::int64_t ms) {
    return HostTime{ms * 1'000'000};
}
SampleFit judge(JointJump& jump, std::int64_t ms, double first, double second = 0.0) {
    return jump.judge(at_ms(ms), std::array{first, second});
}

// 1.5 times 2 rad/s for 10 ms and the 20 ms of both times, and 0.01: 0.1 rad; 0.0325 m of the other.
TEST(JointJump, takes_half_as_much_again_as_the_velocity_limit_and_the_times_allow) {
    for (const auto& [first, second, verdict] :
         {std::tuple{0.0999, 0.0, SampleFit::fits}, std::tuple{0.1001, 0.0, SampleFit::jumped},
          std::tuple{-0.0999, 0.0, SampleFit::fits}, std::tuple{-0.1001, 0.0, SampleFit::jumped},
          std::tuple{0.0, 0.0324, SampleFit::fits}, std::tuple{0.0, 0.0326, SampleFit::jumped}}) {
        JointJump jump(kLimits);
        EXPECT_EQ(judge(jump, 0, 0.0), SampleFit::fits) << "the first one has nothing before it";
        EXPECT_EQ(judge(jump, 10, first, second), verdict) << first << ' ' << second;
    }
    JointJump jump(kLimits);
    (void)judge(jump, 0, 0.0);
    EXPECT_EQ(judge(jump, 500, 1.569), SampleFit::fits) << "after a gap";
    EXPECT_EQ(judge(jump, 1'000, 1.569 + 1.571), SampleFit::jumped);
}

TEST(JointJump, is_none_where_a_continuous_joint_wraps) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    constexpr std::array<JointLimits, 2> kContinuous = {JointLimits{-kInfinity, kInfinity, 2.0}, kLimits[1]};
    JointJump jump(kContinuous);
    const double turn = 2.0 * std::acos(-1.0);
    for (int k = 0; k < 1000; ++k)
        EXPECT_EQ(judge(jump, 10 * k, std::remainder(0.02 * k, turn)), SampleFit::fits) << k;
    EXPECT_EQ(judge(jump, 10'000, std::remainder(20.0 + 0.2, turn)), SampleFit::jumped);
}

TEST(JointJump, says_which_joint_went_how_far_in_which_time) {
    JointJump jump(kLimits);
    EXPECT_FALSE(jump.newest());
    (void)judge(jump, 0, 0.1, 0.2);
    (void)judge(jump, 10, 0.15, 0.6);
    ASSERT_TRUE(jump.newest());
    EXPECT_EQ(jump.newest()->joint, 1U);
    EXPECT_DOUBLE_EQ(jump.newest()->from, 0.2);
    EXPECT_DOUBLE_EQ(jump.newest()->to, 0.6);
    EXPECT_DOUBLE_EQ(jump.newest()->step_max, 0.0325);
    EXPECT_EQ(jump.newest()->passed, std::chrono::milliseconds(10));
    EXPECT_EQ(jump.newest()->sampled, at_ms(10));
}

TEST(JointJump, refuses_one_sample_alone_and_goes_on) {
    JointJump jump(kLimits);
    for (int k = 0; k < 300; ++k) {
        const bool is_odd = k == 50 || k == 151;  // over a second apart
        EXPECT_EQ(judge(jump, 10 * k, is_odd ? 2.0 : 0.0), is_odd ? SampleFit::jumped : SampleFit::fits) << k;
    }
}

// Two programs by turns: from the second's second sample on neither is used, until a second after its last.
TEST(JointJump, uses_neither_of_two_tracks_until_one_was_silent_for_a_second) {
    JointJump jump(kLimits);
    for (int k = 0; k < 100; ++k) EXPECT_EQ(judge(jump, 10 * k, 0.0), SampleFit::fits);
    for (int k = 100; k < 300; ++k) {
        const SampleFit mine = judge(jump, 10 * k, 0.0);
        EXPECT_EQ(mine, k <= 101 ? SampleFit::fits : SampleFit::withheld) << k;
        EXPECT_EQ(judge(jump, 10 * k + 5, 1.0), SampleFit::jumped) << k;
    }
    for (int k = 300; k < 500; ++k) {  // the other's last came at 2995 ms
        EXPECT_EQ(judge(jump, 10 * k, 0.0), k < 400 ? SampleFit::withheld : SampleFit::fits) << k;
    }
}

TEST(JointJump, goes_over_to_the_other_track_once_the_used_one_was_silent_for_a_second) {
    JointJump jump(kLimits);
    EXPECT_EQ(judge(jump, 0, 2.5), SampleFit::fits) << "the first sample may be the wrong one";
    for (int k = 1; k < 300; ++k) {
        EXPECT_EQ(judge(jump, 10 * k, 0.0), k < 100 ? SampleFit::jumped : SampleFit::fits) << k;
    }
    for (int k = 300; k < 500; ++k) EXPECT_EQ(judge(jump, 10 * k, 0.001 * (k - 300)), SampleFit::fits) << k;
}

// While the used one is silent the arm might have moved to where the other is: it did not.
TEST(JointJump, takes_no_growing_doubt_for_a_movement) {
    JointJump jump(kLimits);
    for (int k = 0; k < 10; ++k) (void)judge(jump, 10 * k, 0.5);  // the last at 90 ms
    for (int k = 10; k < 109; ++k) EXPECT_EQ(judge(jump, 10 * k, 0.0), SampleFit::jumped) << k;
    EXPECT_EQ(judge(jump, 1'090, 0.0), SampleFit::fits);
}

// Three tracks: when the used one falls silent there are two still.
TEST(JointJump, goes_over_to_none_of_two_others) {
    JointJump jump(kLimits);
    (void)judge(jump, 0, 0.0);
    for (int k = 1; k < 400; ++k) {
        const SampleFit verdict = judge(jump, 10 * k, k % 2 == 0 ? 1.5 : -1.5);
        EXPECT_NE(verdict, SampleFit::fits) << k;
    }
}

TEST(JointJump, an_arm_that_is_quicker_than_its_description_is_used_again_once_it_is_not) {
    JointJump jump(kLimits);
    double at = 0.0;
    std::vector<SampleFit> verdicts;
    for (int k = 0; k < 500; ++k) {
        at += k >= 100 && k < 120 ? 0.15 : 0.0;  // 15 rad/s
        verdicts.push_back(judge(jump, 10 * k, at));
    }
    EXPECT_EQ(verdicts[99], SampleFit::fits);
    EXPECT_EQ(verdicts[110], SampleFit::jumped);
    for (std::size_t k = 230; k < 500; ++k) EXPECT_EQ(verdicts[k], SampleFit::fits) << k;
}

TEST(JointJump, knows_nothing_of_before_a_leap_of_time) {
    JointJump jump(kLimits);
    for (int k = 0; k < 20; ++k) (void)judge(jump, 10 * k, k % 2 == 0 ? 0.0 : 1.0);
    jump.forget();
    EXPECT_EQ(judge(jump, -5'000, 2.0), SampleFit::fits);
    EXPECT_EQ(judge(jump, -4'990, 2.0), SampleFit::fits);
}

}  // namespace
}  // namespace octoskin
