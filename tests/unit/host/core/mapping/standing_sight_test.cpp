// How far a sensor that stands still has surely seen: the rules of docs/method.md "A sensor that stands
// still", with readings of one zone every 0.3 s.
#include "host/core/mapping/standing_sight.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace octoskin {
namespace {

constexpr std::int64_t kPeriod_ns = 300'000'000;
constexpr double kNoReturn_m = 0.0;  ///< frees nothing

class StandingSightTest : public testing::Test {
  protected:
    std::optional<Beam> take(double frees_m, double x_m = 0.0, std::uint8_t zone = 0) {
        Beam beam;
        beam.source = {1, 2, zone};
        beam.captured = HostTime{now_ns_};
        now_ns_ += kPeriod_ns;
        beam.p_map_sensor = {x_m, 0.0, 0.0};
        if (frees_m > kNoReturn_m) beam.range_m = frees_m;
        beam.sigma_m = 0.01;  // 5 cm nearer is something else
        return sight_.take(beam, frees_m);
    }
    /// A letter for each reading: whether it tells.
    std::string told(const std::vector<double>& ranges_m) {
        std::string letters;
        for (const double range_m : ranges_m) letters += take(range_m) ? 'x' : '.';
        return letters;
    }

    StandingSight sight_{StandingModel{.clears_after_s = 0.55}};
    std::int64_t now_ns_ = 0;
};

TEST_F(StandingSightTest, tells_the_shortest_of_three_and_no_more_until_all_see_further) {
    EXPECT_FALSE(take(1.02));
    EXPECT_FALSE(take(0.99));
    const auto through = take(1.03);
    ASSERT_TRUE(through);
    EXPECT_EQ(through->range_m, 0.99);
    EXPECT_EQ(told({0.99, 0.98, 1.02, 0.99, 1.02, 0.98, 1.0}), ".......");
    EXPECT_EQ(told({1.0, 1.0, 1.0, 1.5, 1.5, 1.5}), ".x...x") << "the newest three";
}

TEST_F(StandingSightTest, tells_that_something_has_gone_that_came) {
    EXPECT_EQ(told({1.0, 1.0, 1.0, 1.0}), "..x.");
    EXPECT_EQ(told({0.5, 1.0, 1.0, 1.0, 1.0}), "x..x.") << "what is before it, then that it has gone";
    EXPECT_EQ(told({0.96, 1.0, 1.0, 1.0}), "....") << "noise";
}

TEST_F(StandingSightTest, sees_as_far_as_all_do_where_they_differ) {
    EXPECT_EQ(told({0.5, 1.5, 0.5, 1.5, 0.5}), "..x..");
    EXPECT_EQ(told({1.5, kNoReturn_m, 1.5, kNoReturn_m}), ".x..") << "and frees nothing";
}

TEST_F(StandingSightTest, waits_for_half_a_second_however_many_readings_that_are) {
    now_ns_ = 0;
    for (int reading = 0; reading < 30; ++reading) {
        now_ns_ = reading * 33'000'000;
        EXPECT_EQ(take(1.0).has_value(), reading == 17) << reading << ": and then it is no news";
    }
}

TEST_F(StandingSightTest, tells_nothing_where_the_sensor_moves) {
    for (int reading = 0; reading < 20; ++reading) EXPECT_FALSE(take(1.0, 0.006 * reading)) << reading;
}

TEST_F(StandingSightTest, hears_each_zone_by_itself) {
    EXPECT_FALSE(take(1.0, 0.0, 0));
    EXPECT_FALSE(take(1.0, 0.0, 1));
    EXPECT_FALSE(take(1.0, 0.0, 0));
    EXPECT_FALSE(take(0.5, 0.0, 1));
    EXPECT_EQ(take(1.0, 0.0, 0).value().range_m, 1.0);
    EXPECT_EQ(take(1.0, 0.0, 1).value().range_m, 0.5);
}

TEST_F(StandingSightTest, tells_nothing_if_the_mapping_says_never_and_forgets) {
    (void)told({1.0, 1.0});
    sight_.forget();
    EXPECT_EQ(told({1.0, 1.0, 1.0}), "..x");
    StandingSight never{StandingModel{}};
    Beam beam;
    beam.range_m = 1.0;
    for (int reading = 0; reading < 20; ++reading) {
        beam.captured.ns += kPeriod_ns;
        EXPECT_FALSE(never.take(beam, 1.0));
    }
}

}  // namespace
}  // namespace octoskin
