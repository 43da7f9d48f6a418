// Interpolation between joint samples, and every way not to answer.
#include "host/core/kinematics/joint_history.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

namespace octoskin {
namespace {

using std::chrono::milliseconds;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::array<JointLimits, 2> kLimits = {JointLimits{-1.0, 2.0}, JointLimits{-3.0, 3.0}};

HostTime at_ms(std::int64_t ms) {
    return HostTime{ms * 1'000'000};
}

/// Samples at 100, 110 and 120 ms.
JointHistory three_samples() {
    JointHistory history(kLimits);
    EXPECT_TRUE(history.add(at_ms(100), std::array{0.0, -1.0}));
    EXPECT_TRUE(history.add(at_ms(110), std::array{1.0, -2.0}));
    EXPECT_TRUE(history.add(at_ms(120), std::array{0.5, 2.0}));
    return history;
}

TEST(JointHistory, gives_a_sample_back_at_its_own_instant_the_first_and_the_last_included) {
    const JointHistory history = three_samples();
    EXPECT_EQ(history.at(at_ms(100))->values[0], 0.0);
    EXPECT_EQ(history.at(at_ms(110))->values[1], -2.0);
    EXPECT_EQ(history.at(at_ms(120))->values[1], 2.0);
    EXPECT_EQ(history.at(at_ms(120))->count, 2U);
    EXPECT_EQ(history.at(at_ms(120))->span().size(), 2U);
}

TEST(JointHistory, interpolates_linearly_at_every_nanosecond_step_of_a_short_bracket) {
    JointHistory history(kLimits);
    ASSERT_TRUE(history.add(HostTime{1000}, std::array{-1.0, 3.0}));
    ASSERT_TRUE(history.add(HostTime{1016}, std::array{1.0, -1.0}));
    for (int step = 0; step <= 16; ++step) {
        const auto position = history.at(HostTime{1000 + step});
        ASSERT_TRUE(position);
        EXPECT_DOUBLE_EQ(position->values[0], -1.0 + step / 8.0);
        EXPECT_DOUBLE_EQ(position->values[1], 3.0 - step / 4.0);
    }
}

TEST(JointHistory, takes_the_two_samples_about_the_instant) {
    const JointHistory history = three_samples();
    EXPECT_DOUBLE_EQ(history.at(at_ms(105))->values[0], 0.5);
    EXPECT_DOUBLE_EQ(history.at(at_ms(115))->values[0], 0.75);
    EXPECT_DOUBLE_EQ(history.at(at_ms(115))->values[1], 0.0);
}

TEST(JointHistory, a_continuous_joint_that_wraps_goes_the_shorter_way_round_for_ever) {
    constexpr std::array<JointLimits, 2> kContinuous = {JointLimits{-kInfinity, kInfinity},
                                                        JointLimits{-4.0, 4.0}};
    const double turn = 2.0 * std::acos(-1.0);
    JointHistory history(kContinuous);
    // Ten turns at 0.3 rad in 10 ms, wrapped to +-pi; the other joint jumps as far and has limits.
    for (int k = 0; k <= 210; ++k) {
        const double wrapped = std::remainder(0.3 * k, turn);
        ASSERT_TRUE(history.add(at_ms(10 * k), std::array{wrapped, wrapped}));
    }
    bool has_wrapped = false;
    for (int k = 0; k < 210; ++k) {
        const auto position = history.at(at_ms(10 * k + 4));
        ASSERT_TRUE(position);
        EXPECT_NEAR(std::remainder(position->values[0] - 0.3 * (k + 0.4), turn), 0.0, 1e-9) << k;
        const double before = std::remainder(0.3 * k, turn), after = std::remainder(0.3 * (k + 1), turn);
        EXPECT_NEAR(position->values[1], before + 0.4 * (after - before), 1e-12) << k;
        has_wrapped = has_wrapped || after < before;
    }
    EXPECT_TRUE(has_wrapped);
}

TEST(JointHistory, never_extrapolates) {
    const JointHistory history = three_samples();
    EXPECT_EQ(history.at(HostTime{100'000'000 - 1}).error(), JointLookup::before_first);
    EXPECT_EQ(history.at(HostTime{120'000'000 + 1}).error(), JointLookup::not_yet);
    EXPECT_EQ(JointHistory(kLimits).at(at_ms(100)).error(), JointLookup::not_yet);
}

TEST(JointHistory, one_sample_answers_for_its_own_instant_only) {
    JointHistory history(kLimits);
    ASSERT_TRUE(history.add(at_ms(100), std::array{0.0, 0.0}));
    EXPECT_TRUE(history.at(at_ms(100)));
    EXPECT_EQ(history.at(at_ms(99)).error(), JointLookup::before_first);
    EXPECT_EQ(history.at(at_ms(101)).error(), JointLookup::not_yet);
}

TEST(JointHistory, answers_across_a_bracket_of_exactly_100_ms_and_none_wider) {
    for (const std::int64_t excess_ns : {-1, 0, 1}) {
        JointHistory history(kLimits);
        ASSERT_TRUE(history.add(HostTime{0}, std::array{0.0, 0.0}));
        ASSERT_TRUE(history.add(HostTime{100'000'000 + excess_ns}, std::array{1.0, 1.0}));
        const auto position = history.at(HostTime{30'000'000});
        EXPECT_EQ(position.has_value(), excess_ns <= 0) << excess_ns;
        if (!position) {
            EXPECT_EQ(position.error(), JointLookup::gap);
        }
    }
}

TEST(JointHistory, answers_within_exactly_50_ms_of_the_nearest_sample_and_not_beyond) {
    JointHistoryConfig config;
    config.bracket_max = milliseconds(1000);
    JointHistory history(kLimits, config);
    ASSERT_TRUE(history.add(at_ms(0), std::array{0.0, 0.0}));
    ASSERT_TRUE(history.add(at_ms(200), std::array{1.0, 1.0}));
    EXPECT_TRUE(history.at(at_ms(50)));
    EXPECT_EQ(history.at(HostTime{50'000'001}).error(), JointLookup::gap);
    EXPECT_EQ(history.at(at_ms(100)).error(), JointLookup::gap);
    EXPECT_EQ(history.at(HostTime{149'999'999}).error(), JointLookup::gap);
    EXPECT_TRUE(history.at(at_ms(150)));
}

TEST(JointHistory, gap_does_not_hide_the_samples_at_its_ends) {
    JointHistory history(kLimits);
    ASSERT_TRUE(history.add(at_ms(0), std::array{0.0, 0.0}));
    ASSERT_TRUE(history.add(at_ms(500), std::array{1.0, 1.0}));
    EXPECT_TRUE(history.at(at_ms(0)));
    EXPECT_EQ(history.at(at_ms(1)).error(), JointLookup::gap);
    EXPECT_EQ(history.at(at_ms(499)).error(), JointLookup::gap);
    EXPECT_TRUE(history.at(at_ms(500)));
}

TEST(JointHistory, rejects_each_bad_sample_by_name_and_is_unchanged) {
    JointHistory history = three_samples();
    const auto rejection = [&](std::int64_t ms, std::vector<double> position) {
        return history.add(at_ms(ms), position).error();
    };
    EXPECT_EQ(rejection(130, {0.0}), JointRejection::wrong_count);
    EXPECT_EQ(rejection(130, {0.0, 0.0, 0.0}), JointRejection::wrong_count);
    EXPECT_EQ(rejection(130, {}), JointRejection::wrong_count);
    EXPECT_EQ(rejection(130, {0.0, kNaN}), JointRejection::not_finite);
    EXPECT_EQ(rejection(130, {-kInfinity, 0.0}), JointRejection::not_finite);
    EXPECT_EQ(rejection(130, {-1.0051, 0.0}), JointRejection::outside_limits);
    EXPECT_EQ(rejection(130, {0.0, 3.0051}), JointRejection::outside_limits);
    EXPECT_EQ(rejection(120, {0.0, 0.0}), JointRejection::out_of_order);
    EXPECT_EQ(rejection(119, {0.0, 0.0}), JointRejection::out_of_order);
    EXPECT_EQ(history.size(), 3U);
    EXPECT_EQ(history.at(at_ms(120))->values[1], 2.0);
    EXPECT_EQ(history.at(at_ms(121)).error(), JointLookup::not_yet);
}

TEST(JointHistory, takes_a_sample_at_its_limits_and_within_their_tolerance) {
    JointHistory history(kLimits);
    EXPECT_TRUE(history.add(at_ms(1), std::array{-1.0, 3.0}));
    EXPECT_TRUE(history.add(at_ms(2), std::array{2.0, -3.0}));
    EXPECT_TRUE(history.add(at_ms(3), std::array{2.0049, -3.0049}));
}

TEST(JointHistory, continuous_joint_has_no_limit) {
    const std::array<JointLimits, 1> limits = {JointLimits{-kInfinity, kInfinity}};
    JointHistory history(limits);
    EXPECT_TRUE(history.add(at_ms(1), std::array{1e6}));
}

TEST(JointHistory, oldest_sample_gives_way_at_every_position_of_the_ring) {
    JointHistoryConfig config;
    config.capacity = 3;
    JointHistory history(kLimits, config);
    for (int i = 0; i < 20; ++i) {
        ASSERT_TRUE(history.add(at_ms(10 * i), std::array{0.05 * i, 0.0}));
        const int oldest = std::max(0, i - 2);
        EXPECT_EQ(history.size(), static_cast<std::size_t>(i - oldest + 1));
        for (int held = oldest; held <= i; ++held) {
            ASSERT_TRUE(history.at(at_ms(10 * held)));
            EXPECT_DOUBLE_EQ(history.at(at_ms(10 * held))->values[0], 0.05 * held);
        }
        EXPECT_EQ(history.at(at_ms(10 * oldest - 1)).error(), JointLookup::before_first);
        if (i > oldest) {
            EXPECT_DOUBLE_EQ(history.at(at_ms(10 * i - 5))->values[0], 0.05 * (i - 0.5));
        }
    }
}

}  // namespace
}  // namespace octoskin
