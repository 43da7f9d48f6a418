// When ranges of a sensor are confirmed at once: the rules of docs/concepts/stationary-sensors.md,
// with 4 readings of the last 7.
#include "host/core/mapping/confirmed_ranges.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace octoskin {
namespace {

constexpr double kSigma_m = 0.01;  ///< so that ranges agree to 5 cm
constexpr std::optional<double> kNothing = std::nullopt;

Beam beam_at(std::optional<double> range_m, std::uint8_t zone = 0, double x_m = 0.0,
             double turned_deg = 0.0) {
    Beam beam;
    beam.source = {1, 2, zone};
    beam.p_map_sensor = {x_m, 0.0, 0.0};
    beam.R_map_sensor =
        Eigen::AngleAxisd(turned_deg * M_PI / 180.0, Eigen::Vector3d::UnitY()).toRotationMatrix();
    // Zones are 9 degrees apart, in a row.
    const double angle = zone * 9.0 * M_PI / 180.0;
    beam.direction_map = beam.R_map_sensor * Eigen::Vector3d(0.0, std::sin(angle), std::cos(angle));
    beam.range_m = range_m;
    beam.sigma_m = kSigma_m;
    beam.optics = {.half_angle_rad = 0.2, .sigma_rad = 0.1};
    return beam;
}

class ConfirmedRangesTest : public testing::Test {
  protected:
    /// How many ranges of something well before the wall, which is at 1 m, are confirmed after each of these,
    /// from one place, of one zone.
    std::vector<std::size_t> take(const std::vector<std::optional<double>>& ranges_m) {
        std::vector<std::size_t> counts;
        for (const auto& range_m : ranges_m) {
            const auto confirmed = ranges_.take(beam_at(range_m), histories_).confirmed;
            counts.push_back(static_cast<std::size_t>(
                std::ranges::count_if(confirmed, [](const Beam& beam) { return *beam.range_m < 0.9; })));
        }
        return counts;
    }
    using Counts = std::vector<std::size_t>;

    SensorHistories histories_;
    ConfirmedRanges ranges_{StationaryModel{.readings = 4}};
};

TEST_F(ConfirmedRangesTest, confirms_the_fourth_that_agrees_and_its_mean) {
    EXPECT_EQ(take({0.50, 0.52, 0.49}), Counts({0, 0, 0}));
    const auto confirmed = ranges_.take(beam_at(0.53), histories_).confirmed;
    ASSERT_EQ(confirmed.size(), 1U);
    EXPECT_NEAR(*confirmed.front().range_m, 0.51, 1e-12);
    EXPECT_EQ(confirmed.front().source, (BeamSource{1, 2, 0}));
}

TEST_F(ConfirmedRangesTest, confirms_nothing_if_the_mapping_says_never) {
    ConfirmedRanges never{StationaryModel{}};
    for (int i = 0; i < 20; ++i) EXPECT_TRUE(never.take(beam_at(0.5), histories_).confirmed.empty());
}

TEST_F(ConfirmedRangesTest, confirms_no_wrong_reading_however_often_one_comes) {
    take({1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0});
    // Every third is wrong: never four in seven.
    for (int i = 0; i < 20; ++i) EXPECT_EQ(take({0.5, 1.0, 1.0}), Counts({0, 0, 0}));
    // And if they do not agree with each other, as many as there are.
    EXPECT_EQ(take({0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.3, 0.6, 0.2}), Counts(10, 0));
}

TEST_F(ConfirmedRangesTest, confirms_what_comes_though_three_of_seven_are_wrong_or_fail) {
    take({1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0});
    EXPECT_EQ(take({0.5, 1.0, 0.5, kNothing, 0.5, 0.2, 0.5}), Counts({0, 0, 0, 0, 0, 0, 1}));
}

TEST_F(ConfirmedRangesTest, confirms_what_was_new_as_long_as_it_stays) {
    const auto counts_of = [&](const std::vector<std::optional<double>>& ranges_m) {
        std::vector<std::size_t> confirmed;
        for (const auto& range_m : ranges_m)
            confirmed.push_back(ranges_.take(beam_at(range_m), histories_).confirmed.size());
        return confirmed;
    };
    counts_of({0.3, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0});
    EXPECT_EQ(counts_of({1.0, 1.0, 1.0, 1.0, 1.0}), Counts({1, 1, 1, 1, 1})) << "new when it began";
    EXPECT_EQ(counts_of(std::vector<std::optional<double>>(12, 0.5)),
              Counts({0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1, 1}));
    EXPECT_EQ(counts_of({1.0, 0.5, kNothing, 1.0, 0.5}), Counts({0, 1, 0, 0, 1}))
        << "two in a row are nothing";
    EXPECT_EQ(counts_of({1.0, 1.0, 1.0, 0.5, 1.0}), Counts(5, 0)) << "three are";
    EXPECT_EQ(counts_of(std::vector<std::optional<double>>(12, 1.0)), Counts(12, 0)) << "it was never nearer";
}

TEST_F(ConfirmedRangesTest, follows_what_it_confirms_as_it_moves_away) {
    take({1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0});
    take({0.5, 0.5, 0.5, 0.5});
    for (double range_m = 0.5; range_m < 0.9; range_m += 0.01) {
        const auto confirmed = ranges_.take(beam_at(range_m), histories_).confirmed;
        ASSERT_EQ(confirmed.size(), 1U) << range_m;
        EXPECT_NEAR(*confirmed.front().range_m, range_m, 0.035);
    }
}

TEST_F(ConfirmedRangesTest, takes_what_was_as_near_before_for_no_news) {
    take({0.54, 1.0, 1.0, 1.0, 1.0});
    // Until the reading of 0.54 m is no longer one of the three before the window.
    EXPECT_EQ(take({0.5, 0.5, 0.5, 0.5, 0.5, 0.5}), Counts({0, 0, 0, 0, 0, 1}));
}

TEST_F(ConfirmedRangesTest, confirms_no_sensor_that_moves_or_turns_faster_than_it_may) {
    for (int i = 0; i < 30; ++i)
        EXPECT_TRUE(ranges_.take(beam_at(0.5, 0, 0.0034 * i), histories_).confirmed.empty());
    histories_.clear();
    for (int i = 0; i < 30; ++i)
        EXPECT_TRUE(ranges_.take(beam_at(0.5, 0, 0.0, 0.34 * i), histories_).confirmed.empty());
}

TEST_F(ConfirmedRangesTest, confirms_a_sensor_that_moves_and_turns_slowly) {
    for (int i = 0; i < 30; ++i) {
        const auto confirmed = ranges_.take(beam_at(0.5, 0, 0.0033 * i, 0.33 * i), histories_).confirmed;
        EXPECT_EQ(confirmed.size(), i < 3 ? 0U : 1U);
    }
}

TEST_F(ConfirmedRangesTest, hears_zones_that_are_ranged_in_turn) {
    for (int cycle = 0; cycle < 2; ++cycle)
        for (std::uint8_t zone = 0; zone < 9; ++zone) (void)ranges_.take(beam_at(1.0, zone), histories_);
    // Something square before zones 4 to 8: what the fourth of them says makes all four confirmed.
    std::vector<std::size_t> counts;
    for (std::uint8_t zone = 4; zone < 9; ++zone)
        counts.push_back(ranges_.take(beam_at(0.5, zone), histories_).confirmed.size());
    EXPECT_EQ(counts, Counts({0, 0, 0, 4, 1}));
}

TEST_F(ConfirmedRangesTest, hears_zones_of_what_comes_again_a_second_after_it_left) {
    const auto cycles_of = [&](int cycles, double range_m) {
        std::size_t confirmed = 0;
        for (int cycle = 0; cycle < cycles; ++cycle)
            for (std::uint8_t zone = 0; zone < 9; ++zone)
                confirmed += ranges_.take(beam_at(range_m, zone), histories_).confirmed.size();
        return confirmed;
    };
    (void)cycles_of(8, 1.0);
    EXPECT_GT(cycles_of(3, 0.5), 0U);
    (void)cycles_of(1, 1.0);           // each stays until its own zone has looked again
    EXPECT_EQ(cycles_of(3, 1.0), 0U);  // of each zone the newest three before are of nothing near
    EXPECT_GT(cycles_of(1, 0.5), 0U);
}

TEST_F(ConfirmedRangesTest, hears_one_zone_by_its_own_readings) {
    std::vector<int> cycles;
    for (int cycle = 0; cycle < 20; ++cycle)
        for (std::uint8_t zone = 0; zone < 9; ++zone) {
            const bool is_there = zone == 4 && cycle >= 10;
            const auto confirmed = ranges_.take(beam_at(is_there ? 0.5 : 1.0, zone), histories_).confirmed;
            if (std::ranges::any_of(confirmed, [](const Beam& beam) { return *beam.range_m == 0.5; }))
                cycles.push_back(cycle);
        }
    ASSERT_FALSE(cycles.empty());
    EXPECT_EQ(cycles.front(), 13) << "with its fourth reading";
    EXPECT_EQ(cycles.size(), 5U + 6U * 9U) << "and from then on whichever zone looks past it";
}

TEST_F(ConfirmedRangesTest, confirms_no_zone_for_what_its_neighbours_have_always_ranged) {
    for (int cycle = 0; cycle < 10; ++cycle)
        for (std::uint8_t zone = 0; zone < 9; ++zone)
            (void)ranges_.take(beam_at(zone == 4 ? 1.0 : 0.5, zone), histories_);
    for (std::uint8_t zone = 0; zone < 9; ++zone)
        for (const Beam& confirmed : ranges_.take(beam_at(0.5, zone), histories_).confirmed)
            EXPECT_NE(confirmed.source.zone, 4U) << "one reading does not change what it was confirmed";
}

TEST_F(ConfirmedRangesTest, names_what_only_repeats_what_is_confirmed) {
    const auto repeats = [&](std::optional<double> range_m) {
        return ranges_.take(beam_at(range_m), histories_).repeats_confirmed;
    };
    for (int i = 0; i < 4; ++i) EXPECT_FALSE(repeats(0.5)) << i << ": it is confirmed with the fourth";
    for (int i = 0; i < 100; ++i) EXPECT_TRUE(repeats(0.5));
    EXPECT_FALSE(repeats(1.0));
    EXPECT_FALSE(repeats(kNothing));
    EXPECT_TRUE(repeats(0.5));
    for (int i = 0; i < 3; ++i) EXPECT_FALSE(repeats(1.0));
    EXPECT_FALSE(repeats(0.5)) << "it was given up";
}

/// Two zones in turn, of which the first sees something before the wall.
class SilentZone : public ConfirmedRangesTest {
  protected:
    ConfirmedRanges::Answer take_after(std::uint8_t zone, double range_m, double period_s) {
        Beam beam = beam_at(range_m, zone);
        captured_s_ += period_s;
        beam.captured = HostTime{static_cast<std::int64_t>(std::llround(1e9 * captured_s_))};
        return ranges_.take(beam, histories_);
    }
    bool confirms_hand_after(std::uint8_t zone, double range_m, double period_s) {
        return std::ranges::any_of(take_after(zone, range_m, period_s).confirmed,
                                   [](const Beam& beam) { return *beam.range_m < 0.9; });
    }
    double captured_s_ = 1.0;
};

TEST_F(SilentZone, is_believed_until_three_of_its_readings_have_not_come) {
    for (const double period_s : {0.016, 0.033, 0.15}) {
        histories_.clear();
        for (int i = 0; i < 20; ++i)
            for (const std::uint8_t zone : {std::uint8_t{0}, std::uint8_t{1}})
                (void)take_after(zone, 1.0, period_s);
        for (int i = 0; i < 8; ++i)
            for (const std::uint8_t zone : {std::uint8_t{0}, std::uint8_t{1}})
                (void)take_after(zone, zone == 0 ? 0.4 : 1.0, period_s);
        // The first zone is due about one period before each of these.
        for (int i = 1; i <= 3; ++i)
            EXPECT_TRUE(confirms_hand_after(1, 1.0, 1.9 * period_s)) << i << ' ' << period_s;
        const auto answer = take_after(1, 1.0, 1.9 * period_s);
        ASSERT_EQ(answer.ended.size(), 1U);
        EXPECT_NEAR(*answer.ended.front().range_m, 0.4, 1e-9);
        EXPECT_FALSE(confirms_hand_after(1, 1.0, 1.9 * period_s));
    }
}

TEST_F(SilentZone, is_believed_again_with_its_fourth_reading_after_a_gap) {
    for (int i = 0; i < 20; ++i) (void)take_after(0, 1.0, 0.033);
    for (int i = 0; i < 20; ++i) (void)take_after(0, 0.4, 0.033);
    for (const double gap_s : {0.2, 0.9, 5.0}) {
        EXPECT_FALSE(confirms_hand_after(0, 0.4, gap_s));
        EXPECT_FALSE(confirms_hand_after(0, 0.4, 0.033));
        EXPECT_FALSE(confirms_hand_after(0, 0.4, 0.033));
        for (int i = 0; i < 20; ++i) EXPECT_TRUE(confirms_hand_after(0, 0.4, 0.033)) << gap_s;
    }
}

// Nine in turn, each ranged every 1.3 s.
TEST_F(SilentZone, is_none_however_slow_it_is) {
    for (int cycle = 0; cycle < 20; ++cycle)
        for (std::uint8_t zone = 0; zone < 9; ++zone) (void)take_after(zone, 1.0, 0.14);
    std::vector<bool> confirmed;
    for (int cycle = 0; cycle < 6; ++cycle)
        for (std::uint8_t zone = 0; zone < 9; ++zone) {
            const bool is_confirmed = confirms_hand_after(zone, zone == 4 ? 0.4 : 1.0, 0.14);
            if (zone == 4) confirmed.push_back(is_confirmed);
        }
    EXPECT_EQ(confirmed, (std::vector<bool>{false, false, false, true, true, true}));
}

TEST_F(SilentZone, is_forgotten_with_all_its_readings_once_they_are_too_old) {
    for (int i = 0; i < 20; ++i) (void)take_after(0, 0.4, 0.033);
    EXPECT_TRUE(confirms_hand_after(0, 0.4, 0.1)) << "two are missing";
    EXPECT_EQ(take_after(0, 0.4, 1.2).ended.size(), 1U);
    EXPECT_FALSE(confirms_hand_after(0, 0.4, 0.033));
    EXPECT_FALSE(confirms_hand_after(0, 0.4, 0.033));
    EXPECT_TRUE(confirms_hand_after(0, 0.4, 0.033)) << "the fourth after that";
}

TEST_F(ConfirmedRangesTest, names_what_is_confirmed_no_longer) {
    const auto ended = [&](std::optional<double> range_m) {
        return ranges_.take(beam_at(range_m), histories_).ended.size();
    };
    for (int i = 0; i < 8; ++i) EXPECT_EQ(ended(0.5), 0U);
    EXPECT_EQ(ended(1.0), 0U);
    EXPECT_EQ(ended(1.0), 0U);
    EXPECT_EQ(ended(kNothing), 1U);
    EXPECT_EQ(ended(1.0), 0U);
}

TEST_F(ConfirmedRangesTest, does_not_name_what_a_sensor_leaves_behind_that_moves_on) {
    for (int i = 0; i < 8; ++i) EXPECT_TRUE(ranges_.take(beam_at(0.5), histories_).ended.empty());
    for (int i = 1; i < 20; ++i)
        EXPECT_TRUE(ranges_.take(beam_at(0.5, 0, 0.02 * i), histories_).ended.empty()) << i;
}

TEST_F(ConfirmedRangesTest, knows_who_has_stood_for_a_window) {
    for (int i = 0; i < 30; ++i) EXPECT_EQ(ranges_.take(beam_at(0.5), histories_).is_stationary, i >= 7) << i;
    histories_.clear();
    // To and fro.
    for (int i = 0; i < 60; ++i)
        EXPECT_FALSE(ranges_.take(beam_at(0.5, 0, i % 7 == 0 ? 0.02 : 0.0), histories_).is_stationary) << i;
}

TEST_F(ConfirmedRangesTest, keeps_sensors_apart) {
    for (std::uint8_t i = 0; i < 12; ++i) {
        Beam beam = beam_at(0.5);
        beam.source = {static_cast<std::uint8_t>(i % 2), static_cast<std::uint8_t>(i / 2 % 2), 0};
        EXPECT_TRUE(ranges_.take(beam, histories_).confirmed.empty());
    }
}

TEST_F(ConfirmedRangesTest, begins_anew_after_forget) {
    take({0.5, 0.5, 0.5});
    histories_.clear();
    EXPECT_EQ(take({0.5, 0.5, 0.5, 0.5}), Counts({0, 0, 0, 1}));
}

}  // namespace
}  // namespace octoskin
