// A cone of sub-rays. Oracles: a plane's echoes summed in a loop of this file's own, a search over all
// stretches of range, and numbers by hand.
#include "hw/sim/camera/cone_view.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <random>

#include "hw/rigfile/zone.hpp"

namespace octoskin::sim {
namespace {

constexpr double kRadPerDegree = 3.14159265358979323846 / 180.0;

double sum(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0);
}

TEST(ConeView, is_a_disc_cut_out_of_a_grid) {
    const ConeView view({.sub_rays = 4, .half_angle_deg = 12.0, .sigma_deg = 6.0, .blur_deg = 2.5});
    // Of 4 x 4 places at -9, -3, 3 and 9 degrees the corners lie 12.7 degrees off the axis.
    ASSERT_EQ(view.directions_sensor().size(), 12U);
    const Eigen::Vector3d first(std::tan(-3.0 * kRadPerDegree), std::tan(-9.0 * kRadPerDegree), 1.0);
    EXPECT_NEAR((view.directions_sensor()[0] - first.normalized()).norm(), 0.0, 1e-12);
    EXPECT_EQ(ConeView(rig::Cone{}).directions_sensor().size(), 208U);
}

TEST(ConeView, weighs_less_away_from_the_axis) {
    const ConeView view({.sub_rays = 4, .half_angle_deg = 12.0, .sigma_deg = 6.0, .blur_deg = 2.5});
    const auto weights = view.weights(Roi{});
    EXPECT_NEAR(sum(weights), 1.0, 1e-12);
    // Four of the twelve are 4.24 degrees off the axis, eight 9.49: exp(-0.25) and exp(-1.25) but for the
    // small difference of angles and tangents.
    EXPECT_NEAR(weights[0] / weights[3], std::exp(-1.0), 2e-2);
}

TEST(ConeView, whole_array_sees_what_the_zones_that_tile_it_see_together) {
    const ConeView view{rig::Cone{}};
    const auto whole = view.weights(Roi{});
    std::vector<double> together(whole.size(), 0.0);
    for (const std::uint8_t centre :
         {std::uint8_t{163}, std::uint8_t{227}, std::uint8_t{92}, std::uint8_t{28}}) {
        const auto zone = view.weights({centre, 8, 8});
        EXPECT_NEAR(sum(zone), 0.25, 1e-12) << "centre " << int{centre};  // by symmetry
        std::transform(zone.begin(), zone.end(), together.begin(), together.begin(), std::plus<>());
    }
    for (std::size_t i = 0; i < whole.size(); ++i) EXPECT_NEAR(together[i], whole[i], 1e-15);
}

TEST(ConeView, sharp_lens_gives_each_zone_what_lies_on_its_side) {
    const ConeView view({.sub_rays = 16, .half_angle_deg = 30.0, .sigma_deg = 20.0, .blur_deg = 0.1});
    const auto whole = view.weights(Roi{});
    const auto left = view.weights({.centre_spad = 167, .width = 8, .height = 16});  // looks to the right
    for (std::size_t i = 0; i < whole.size(); ++i) {
        const bool is_right = view.directions_sensor()[i].x() > 0.0;
        EXPECT_NEAR(left[i], is_right ? whole[i] : 0.0, 1e-12);
    }
}

TEST(ConeView, zone_looks_where_the_rig_says_and_sees_less_than_the_whole) {
    const ConeView view{rig::Cone{}};
    const Roi corner{.centre_spad = 28, .width = 8, .height = 8};  // lower right: looks up and to the left
    const auto weights = view.weights(corner);
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < weights.size(); ++i) middle += weights[i] * view.directions_sensor()[i];
    EXPECT_LT(middle.x(), 0.0);
    EXPECT_GT(middle.y(), 0.0);
    EXPECT_GT(middle.normalized().dot(rig::zone_direction(corner)), std::cos(1.0 * kRadPerDegree));
}

TEST(ConeView, echo_is_lamberts) {
    EXPECT_DOUBLE_EQ(echo_signal(1.0, 0.5, 1.0, 1.0), 0.5);
    EXPECT_DOUBLE_EQ(echo_signal(0.1, 0.5, 0.5, 2.0), 0.00625);
    EXPECT_DOUBLE_EQ(echo_signal(1.0, 0.5, 1.0, 0.0), echo_signal(1.0, 0.5, 1.0, 0.01));
}

TEST(NearestPeak, of_nothing_is_none) {
    std::vector<Echo> echoes;
    EXPECT_FALSE(nearest_peak(echoes));
    echoes = {{1.0, 0.0}, {2.0, 0.0}};
    EXPECT_FALSE(nearest_peak(echoes));
}

TEST(NearestPeak, is_the_mean_of_what_lies_within_15_cm) {
    std::vector<Echo> echoes = {{1.1, 3.0}, {1.0, 1.0}, {1.16, 4.0}};
    const auto peak = nearest_peak(echoes);  // from 1.0 on: 4 of the most, 7
    EXPECT_NEAR(peak->range_m, (1.0 + 3.3) / 4.0, 1e-12);
    EXPECT_NEAR(peak->signal, 4.0, 1e-12);
}

TEST(NearestPeak, takes_a_near_thing_from_30_percent_of_the_strongest_on) {
    std::vector<Echo> echoes = {{0.5, 0.299}, {1.0, 1.0}};
    EXPECT_NEAR(nearest_peak(echoes)->range_m, 1.0, 1e-12);
    echoes = {{1.0, 1.0}, {0.5, 0.301}};
    EXPECT_NEAR(nearest_peak(echoes)->range_m, 0.5, 1e-12);
}

/// The same by asking every echo for the stretch that begins at it.
Echo nearest_by_search(const std::vector<Echo>& echoes) {
    const auto stretch_from = [&](double begin_m) {
        Echo all;
        for (const Echo& echo : echoes) {
            if (echo.range_m < begin_m || echo.range_m > begin_m + 0.15) continue;
            all.signal += echo.signal;
            all.range_m += echo.signal * echo.range_m;
        }
        return all;
    };
    double most = 0.0;
    for (const Echo& echo : echoes) most = std::max(most, stretch_from(echo.range_m).signal);
    double begin_m = 1e9;
    for (const Echo& echo : echoes) {
        if (stretch_from(echo.range_m).signal >= 0.3 * most) begin_m = std::min(begin_m, echo.range_m);
    }
    const Echo found = stretch_from(begin_m);
    return {found.range_m / found.signal, found.signal};
}

TEST(NearestPeak, agrees_with_a_search_over_random_echoes) {
    std::mt19937_64 random(20261125);
    const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
    for (int trial = 0; trial < 500; ++trial) {
        std::vector<Echo> echoes(1 + random() % 60);
        for (Echo& echo : echoes) echo = {0.1 + uniform() * (trial % 2 == 0 ? 0.4 : 3.0), uniform()};
        const Echo expected = nearest_by_search(echoes);
        const auto peak = nearest_peak(echoes);
        ASSERT_TRUE(peak);
        EXPECT_NEAR(peak->range_m, expected.range_m, 1e-12) << "trial " << trial;
        EXPECT_NEAR(peak->signal, expected.signal, 1e-12) << "trial " << trial;
    }
}

}  // namespace
}  // namespace octoskin::sim
