// How far a stationary sensor has surely seen: the rules of docs/concepts/stationary-sensors.md, with
// readings of one zone every 0.3 s.
#include "host/core/mapping/seen_through.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace octoskin {
namespace {

constexpr std::int64_t kPeriod_ns = 300'000'000;
constexpr double kNoReturn_m = 0.0;  ///< frees nothing

class SeenThroughTest : public testing::Test {
  protected:
    Beam beam(double frees_m, double x_m = 0.0, std::uint8_t zone = 0) {
        Beam beam;
        beam.source = {1, 2, zone};
        beam.captured = HostTime{now_ns_};
        now_ns_ += kPeriod_ns;
        beam.p_map_sensor = {x_m, 0.0, 0.0};
        if (frees_m > kNoReturn_m) beam.range_m = frees_m;
        return beam;
    }
    /// How far it is seen through, in centimetres, after each reading.
    std::string seen(const std::vector<double>& ranges_m) {
        std::string text;
        for (const double range_m : ranges_m) {
            const Beam* const through = sight_.take(beam(range_m), range_m, histories_);
            text += through == nullptr ? " -" : " " + std::to_string(std::lround(100.0 * *through->range_m));
        }
        return text;
    }

    SensorHistories histories_;
    SeenThrough sight_{StationaryModel{.clears_after_s = 0.55}};
    std::int64_t now_ns_ = 0;
};

TEST_F(SeenThroughTest, is_the_shortest_of_the_newest_three) {
    EXPECT_EQ(seen({1.02, 0.99, 1.03, 1.01, 1.05, 1.06, 1.02}), " - - 99 99 101 101 102");
    EXPECT_EQ(seen({0.5, 1.0, 1.0, 1.0}), " 50 50 50 100");
}

TEST_F(SeenThroughTest, takes_half_a_second_however_many_readings_that_are) {
    for (int reading = 0; reading < 30; ++reading) {
        now_ns_ = reading * 33'000'000;
        EXPECT_EQ(sight_.take(beam(1.0), 1.0, histories_) != nullptr, reading >= 17) << reading;
    }
    now_ns_ = 30 * 33'000'000;
    EXPECT_EQ(*sight_.take(beam(2.0), 2.0, histories_)->range_m, 1.0);
    for (int reading = 31; reading < 47; ++reading) {
        now_ns_ = reading * 33'000'000;
        EXPECT_EQ(*sight_.take(beam(2.0), 2.0, histories_)->range_m, 1.0)
            << "of so long, not of the newest three";
    }
    now_ns_ = 47 * 33'000'000;
    EXPECT_EQ(*sight_.take(beam(2.0), 2.0, histories_)->range_m, 2.0);
}

TEST_F(SeenThroughTest, is_none_where_readings_are_further_apart_than_they_may_be) {
    EXPECT_EQ(seen({1.0, 1.0}), " - -");
    now_ns_ += 20'000'000'000;
    EXPECT_EQ(seen({1.0, 1.0, 1.0}), " - - 100");
    now_ns_ += kPeriod_ns;
    EXPECT_EQ(seen({1.0, 1.0}), " 100 100") << "one was lost";
    for (int reading = 0; reading < 20; ++reading) {
        now_ns_ += 2 * kPeriod_ns;
        EXPECT_EQ(seen({1.0}), " -");
    }
}

TEST_F(SeenThroughTest, is_not_told_by_what_frees_nothing) {
    EXPECT_EQ(seen({1.0, kNoReturn_m, 1.0, 1.0, kNoReturn_m, 1.0}), " - - - 100 - 100");
}

TEST_F(SeenThroughTest, is_none_where_the_sensor_moves) {
    for (int reading = 0; reading < 20; ++reading)
        EXPECT_EQ(sight_.take(beam(1.0, 0.006 * reading), 1.0, histories_), nullptr) << reading;
    for (int reading = 0; reading < 20; ++reading)
        EXPECT_EQ(sight_.take(beam(1.0, 0.011 * (reading % 2)), 1.0, histories_), nullptr) << reading;
    for (int reading = 0; reading < 20; ++reading)
        EXPECT_EQ(sight_.take(beam(1.0, 1.0 + 0.004 * reading), 1.0, histories_) != nullptr, reading >= 2)
            << "a creep";
}

TEST_F(SeenThroughTest, hears_each_zone_by_itself) {
    for (int reading = 0; reading < 3; ++reading) {
        now_ns_ = reading * kPeriod_ns;
        const Beam far = beam(1.0, 0.0, 0);
        now_ns_ = reading * kPeriod_ns;
        const Beam near = beam(0.5, 0.0, 1);
        EXPECT_EQ(sight_.take(far, 1.0, histories_) != nullptr, reading == 2);
        EXPECT_EQ(sight_.take(near, 0.5, histories_) != nullptr, reading == 2);
    }
}

TEST_F(SeenThroughTest, knows_where_other_zones_ranges_end_as_long_as_they_are_new) {
    const auto ends_at = [](double range_m) {
        return [range_m](const Beam& beam) { return *beam.range_m == range_m; };
    };
    (void)sight_.take(beam(0.5, 0.0, 1), 0.5, histories_);
    (void)sight_.take(beam(1.0, 0.0, 2), 1.0, histories_);
    EXPECT_TRUE(sight_.any_newest(HostTime{1'100'000'000}, histories_, ends_at(0.5)));
    EXPECT_FALSE(sight_.any_newest(HostTime{1'110'000'000}, histories_, ends_at(0.5)));
    EXPECT_TRUE(sight_.any_newest(HostTime{1'110'000'000}, histories_, ends_at(1.0)));
    (void)sight_.take(beam(0.7, 0.0, 1), 0.7, histories_);
    EXPECT_TRUE(sight_.any_newest(HostTime{600'000'000}, histories_, ends_at(0.5)))
        << "the newer one may be wrong";
    (void)sight_.take(beam(0.7, 0.0, 1), 0.7, histories_);
    EXPECT_FALSE(sight_.any_newest(HostTime{600'000'000}, histories_, ends_at(0.5)))
        << "two newer ones of the zone";
}

TEST_F(SeenThroughTest, is_none_if_the_mapping_says_never_and_is_forgotten) {
    (void)seen({1.0, 1.0});
    histories_.clear();
    EXPECT_EQ(seen({1.0, 1.0, 1.0}), " - - 100");
    SeenThrough never{StationaryModel{}};
    for (int reading = 0; reading < 20; ++reading) EXPECT_EQ(never.take(beam(1.0), 1.0, histories_), nullptr);
}

}  // namespace
}  // namespace octoskin
