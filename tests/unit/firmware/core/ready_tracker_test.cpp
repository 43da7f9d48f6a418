// Oracle: a sensor of known period and phase, in plain 64-bit arithmetic.
#include "firmware/core/ready_tracker.hpp"

#include <gtest/gtest.h>

#include <random>

namespace octoskin::node {
namespace {

constexpr Policy kPolicy;

constexpr Microseconds kNominal{33'000};

/// Ready times of a sensor: evenly spaced from `first_us` on.
struct EvenSensor {
    double first_us = 0.0;
    double period_us = 33'000.0;
    [[nodiscard]] NodeTime ready(int range) const {
        const double us = first_us + range * period_us;
        return {static_cast<std::uint32_t>(static_cast<std::uint64_t>(us))};
    }
};

TimeBracket around(NodeTime time, std::int64_t before_us, std::int64_t after_us) {
    return {time - Microseconds{before_us}, time + Microseconds{after_us}};
}

ReadyTracker fresh_tracker() {
    ReadyTracker tracker{kPolicy};
    tracker.restart(kNominal, 120);
    return tracker;
}

TEST(ReadyTracker, knows_nothing_before_the_first_range) {
    EXPECT_FALSE(fresh_tracker().predict(1).has_value());
    EXPECT_FALSE(fresh_tracker().measured_period().has_value());
}

TEST(ReadyTracker, expects_the_second_range_within_the_uncertainty_of_the_unmeasured_period) {
    ReadyTracker tracker = fresh_tracker();
    (void)tracker.observe({{1'000'000}, {1'000'400}}, 1);
    const auto predicted = tracker.predict(1);
    ASSERT_TRUE(predicted.has_value());
    // 33 ms -+ 12 %, and 30 us of jitter each for the range that was seen and the one to come
    EXPECT_EQ(predicted->earliest, NodeTime{1'000'000 + 29'040 - 60});
    EXPECT_EQ(predicted->latest, NodeTime{1'000'400 + 36'960 + 60});
}

TEST(ReadyTracker, measures_a_period_seven_percent_off_to_two_tenths_of_a_percent_in_ten_ranges) {
    ReadyTracker tracker = fresh_tracker();
    const EvenSensor sensor{.first_us = 1e6, .period_us = 35'310.0};
    for (int range = 0; range <= 10; ++range) (void)tracker.observe(around(sensor.ready(range), 150, 150), 1);
    const auto measured = tracker.measured_period();
    ASSERT_TRUE(measured.has_value());
    EXPECT_NEAR(static_cast<double>(measured->value.count()), 35'310.0, 35.0);
    EXPECT_LE(measured->uncertainty.count(), 60);
    EXPECT_GE(measured->uncertainty.count(), std::abs(measured->value.count() - 35'310));
}

TEST(ReadyTracker, does_not_measure_from_a_ready_time_that_was_known_badly) {
    ReadyTracker tracker = fresh_tracker();
    const EvenSensor sensor{.first_us = 1e6};
    (void)tracker.observe(around(sensor.ready(0), 1'000, 1'000), 1);
    for (int range = 1; range <= 4; ++range) (void)tracker.observe(around(sensor.ready(range), 100, 100), 1);
    // 200 us and jitter twice over three ranges, and what the period may have drifted; not 2,200 us over
    // four.
    EXPECT_LE(tracker.predict(1)->width(), Microseconds{200 + 2 * 60 + (2 * (200 + 60) + 60) / 3 + 40});
}

TEST(ReadyTracker, carries_the_rhythm_over_polls_that_came_too_late) {
    ReadyTracker tracker = fresh_tracker();
    const EvenSensor sensor{.first_us = 1e6, .period_us = 33'330.0};
    for (int range = 0; range <= 64; ++range) (void)tracker.observe(around(sensor.ready(range), 100, 100), 1);
    // The bus was taken: seen 4 ms late, with nothing known from below but the last read.
    const TimeBracket late{sensor.ready(64) + Microseconds{1'000}, sensor.ready(65) + Microseconds{4'000}};
    const TimeBracket ready = tracker.observe(late, 1);
    EXPECT_TRUE(ready.contains(sensor.ready(65)));
    EXPECT_LE(ready.width().count(), 400);
}

TEST(ReadyTracker, places_a_range_that_followed_others_nobody_read) {
    ReadyTracker tracker = fresh_tracker();
    const EvenSensor sensor{.first_us = 1e6, .period_us = 31'000.0};
    for (int range = 0; range <= 20; ++range) (void)tracker.observe(around(sensor.ready(range), 100, 100), 1);
    const TimeBracket late{sensor.ready(20), sensor.ready(25) + Microseconds{9'000}};
    const TimeBracket ready = tracker.observe(late, 5);
    EXPECT_TRUE(ready.contains(sensor.ready(25)));
    EXPECT_LE(ready.width().count(), 1'000);
}

TEST(ReadyTracker, holds_the_truth_within_its_bracket_for_all_seeds_periods_and_poll_patterns) {
    for (std::uint32_t seed = 0; seed < 200; ++seed) {
        std::mt19937 random(seed);
        const auto draw = [&](int low, int high) { return std::uniform_int_distribution(low, high)(random); };
        // Starts 5 s before the clock wraps, so that most of each run crosses it.
        const EvenSensor sensor{.first_us = 4'294'967'296.0 - 5e6 + draw(0, 40'000),
                                .period_us = 33'000.0 * draw(9'300, 10'700) / 10'000.0};
        ReadyTracker tracker = fresh_tracker();
        for (int range = 0; range < 300; ++range) {
            const NodeTime jittered = sensor.ready(range) + Microseconds{draw(-30, 30)};
            const bool is_late = draw(0, 3) == 0;
            const TimeBracket seen = is_late ? around(jittered, 25'000, draw(0, 5'000))
                                             : around(jittered, draw(0, 400), draw(0, 400));
            const TimeBracket ready = tracker.observe(seen, 1);
            ASSERT_TRUE(ready.contains(jittered)) << "seed " << seed << " range " << range;
        }
    }
}

TEST(ReadyTracker, keeps_the_rhythm_over_a_single_skipped_slot) {
    ReadyTracker tracker = fresh_tracker();
    const EvenSensor sensor{.first_us = 1e6, .period_us = 33'000.0};
    for (int range = 0; range <= 20; ++range) (void)tracker.observe(around(sensor.ready(range), 100, 100), 1);
    const TimeBracket ready = tracker.observe(around(sensor.ready(22), 100, 100), 1);
    EXPECT_TRUE(ready.contains(sensor.ready(22)));
    EXPECT_NEAR(static_cast<double>(tracker.period().count()), 33'000.0, 40.0);
}

TEST(ReadyTracker, learns_a_doubled_period_when_every_second_slot_is_skipped) {
    ReadyTracker tracker = fresh_tracker();
    const EvenSensor sensor{.first_us = 1e6, .period_us = 66'000.0};
    for (int range = 0; range <= 12; ++range) (void)tracker.observe(around(sensor.ready(range), 100, 100), 1);
    EXPECT_NEAR(static_cast<double>(tracker.period().count()), 66'000.0, 100.0);
}

TEST(ReadyTracker, follows_a_period_that_drifts_by_one_and_a_half_percent_in_a_minute) {
    ReadyTracker tracker = fresh_tracker();
    double us = 1e6;
    double period_us = 33'000.0;
    for (int range = 0; range < 1'800; ++range) {
        const NodeTime truth{static_cast<std::uint32_t>(us)};
        const TimeBracket ready = tracker.observe(around(truth, 150, 150), 1);
        ASSERT_TRUE(ready.contains(truth)) << range;
        period_us += 495.0 / 1'800;
        us += period_us;
    }
    EXPECT_NEAR(static_cast<double>(tracker.period().count()), 33'495.0, 40.0);
}

TEST(ReadyTracker, keeps_sane_intervals_whatever_the_period_does) {
    for (std::uint32_t seed = 0; seed < 300; ++seed) {
        std::mt19937 random(seed);
        const auto draw = [&](int low, int high) { return std::uniform_int_distribution(low, high)(random); };
        ReadyTracker tracker = fresh_tracker();
        double us = 1e6;
        double period_us = 33'000.0;
        for (int range = 0; range < 200; ++range) {
            const NodeTime truth{static_cast<std::uint32_t>(us)};
            const int before_us = draw(0, 2'000);
            const int after_us = draw(0, 2'000);
            const TimeBracket seen = around(truth, before_us, after_us);
            const TimeBracket ready = tracker.observe(seen, 1);
            ASSERT_TRUE(is_reached(ready.earliest, ready.latest)) << "seed " << seed << " range " << range;
            ASSERT_TRUE(is_reached(seen.earliest, ready.earliest) && is_reached(ready.latest, seen.latest));
            const auto predicted = tracker.predict(1);
            ASSERT_TRUE(predicted.has_value());
            ASSERT_GT(predicted->width().count(), 0) << "seed " << seed << " range " << range;
            period_us *= 1.0 + 1e-6 * draw(-4'000, 4'000);  // ten times what any oscillator does
            us += period_us;
        }
    }
}

TEST(ReadyTracker, believes_a_poll_that_contradicts_the_rhythm) {
    ReadyTracker tracker = fresh_tracker();
    const EvenSensor sensor{.first_us = 1e6, .period_us = 33'000.0};
    for (int range = 0; range <= 20; ++range) (void)tracker.observe(around(sensor.ready(range), 100, 100), 1);
    const NodeTime slipped = sensor.ready(21) + Microseconds{5'000};
    const TimeBracket ready = tracker.observe(around(slipped, 200, 200), 1);
    EXPECT_EQ(ready, around(slipped, 200, 200));
}

TEST(ReadyTracker, admits_wide_doubt_when_data_was_ready_before_it_could_be) {
    ReadyTracker tracker = fresh_tracker();
    const EvenSensor sensor{.first_us = 1e6, .period_us = 33'000.0};
    for (int range = 0; range <= 20; ++range) (void)tracker.observe(around(sensor.ready(range), 100, 100), 1);
    const NodeTime early = sensor.ready(21) - Microseconds{700};
    const TimeBracket ready = tracker.observe({sensor.ready(20), early + Microseconds{50}}, 1);
    EXPECT_TRUE(ready.contains(early));
    EXPECT_GE(ready.width().count(), 400);
    EXPECT_LE(ready.width().count(), 2'000);
}

}  // namespace
}  // namespace octoskin::node
