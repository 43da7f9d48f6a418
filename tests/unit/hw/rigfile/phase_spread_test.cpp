// Whether sensors take turns, on their bus and in the light.
#include "hw/rigfile/phase_spread.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace octoskin::rig {
namespace {

/// `phases_us.size()` sensors on bus 0, 33 ms each, 20 ms of budget.
NodeConfig node_of(std::initializer_list<std::uint16_t> phases_us) {
    NodeConfig node;
    for (const std::uint16_t phase_us : phases_us) {
        SensorConfig& sensor = node.sensors[node.sensor_count++];
        sensor.phase_us = phase_us;
    }
    return node;
}
// 518 bits at 283 kHz.
constexpr double kReadingUs = 518.0 / 0.283;

TEST(PhaseSpread, of_a_bus_without_sensors_is_nothing) {
    const PhaseSpread spread = phase_spread(node_of({0}), 1);
    EXPECT_EQ(spread.mean, 0.0);
    EXPECT_TRUE(spread.is_even());
}

TEST(PhaseSpread, of_one_sensor_is_one_reading) {
    const PhaseSpread spread = phase_spread(node_of({12'345}), 0);
    EXPECT_NEAR(spread.mean, kReadingUs / 33'000.0, 1e-9);
    EXPECT_NEAR(spread.peak, kReadingUs / 5'000.0, 1e-9);
    EXPECT_TRUE(spread.is_even());
}

TEST(PhaseSpread, of_sensors_that_all_begin_at_once_is_not_even) {
    const PhaseSpread spread = phase_spread(node_of({0, 0, 0, 0}), 0);
    EXPECT_NEAR(spread.mean, 4 * kReadingUs / 33'000.0, 1e-9);
    EXPECT_NEAR(spread.peak, 4 * kReadingUs / 5'000.0, 1e-9);
    EXPECT_FALSE(spread.is_even());
}

TEST(PhaseSpread, sees_two_readings_in_one_window_across_the_end_of_the_period_too) {
    EXPECT_FALSE(phase_spread(node_of({0, 2'000}), 0).is_even());
    EXPECT_FALSE(phase_spread(node_of({32'500, 500}), 0).is_even());
    EXPECT_TRUE(phase_spread(node_of({0, 16'500}), 0).is_even());
    // Two whole readings fit 5 ms while they begin less than 5 ms - 1.83 ms apart; 6.9 ms apart not a bit of
    // the second is in it.
    EXPECT_NEAR(phase_spread(node_of({0, 3'100}), 0).peak, 2 * kReadingUs / 5'000.0, 1e-6);
    EXPECT_NEAR(phase_spread(node_of({0, 6'900}), 0).peak, kReadingUs / 5'000.0, 1e-9);
}

TEST(PhaseSpread, of_sensors_with_two_periods_is_taken_over_both) {
    NodeConfig node = node_of({0, 10'000});
    node.sensors[1].inter_measurement_ms = 44;  // together again every 132 ms, and close by in between
    EXPECT_NEAR(phase_spread(node, 0).mean, kReadingUs / 33'000.0 + kReadingUs / 44'000.0, 1e-9);
    EXPECT_FALSE(phase_spread(node, 0).is_even());
}

/// Two sensors `angle_deg` apart on one link.
Node pair_of(double angle_deg, std::uint16_t phase_us) {
    Node node;
    node.config = node_of({0, phase_us});
    node.sensors.resize(2);
    for (Sensor& sensor : node.sensors) sensor.link = "flange";
    node.sensors[1].T_link_sensor.rotate(
        Eigen::AngleAxisd(angle_deg * std::numbers::pi / 180.0, Eigen::Vector3d::UnitX()));
    return node;
}

TEST(PairsRangingTogether, are_those_that_see_one_place_in_overlapping_windows) {
    EXPECT_EQ(pairs_ranging_together(pair_of(26.0, 0)).size(), 1U);
    EXPECT_TRUE(pairs_ranging_together(pair_of(28.0, 0)).empty());
    // 20 ms and 20 ms of 33 overlap by 7 at least: with phases 13 to 20 ms apart.
    EXPECT_TRUE(pairs_ranging_together(pair_of(10.0, 13'000)).empty());
    EXPECT_TRUE(pairs_ranging_together(pair_of(10.0, 20'000)).empty());
    EXPECT_EQ(pairs_ranging_together(pair_of(10.0, 11'500)).size(), 1U);
    EXPECT_EQ(pairs_ranging_together(pair_of(10.0, 21'500)).size(), 1U);
}

TEST(PairsRangingTogether, are_those_that_look_at_each_other) {
    Node node = pair_of(180.0, 0);
    EXPECT_TRUE(pairs_ranging_together(node).empty()) << "in one place, back to back";
    node.sensors[1].T_link_sensor.translation() = Eigen::Vector3d(0.0, 0.0, 0.3);
    EXPECT_EQ(pairs_ranging_together(node).size(), 1U);
    node.sensors[1].T_link_sensor.translation() = Eigen::Vector3d(0.0, 0.0, -0.3);
    EXPECT_TRUE(pairs_ranging_together(node).empty()) << "away from each other";
}

TEST(PairsRangingTogether, are_not_told_of_links_that_move_against_each_other) {
    Node node = pair_of(0.0, 0);
    node.sensors[1].link = "elbow";
    EXPECT_TRUE(pairs_ranging_together(node).empty());
}

/// Sensors of one phase, each this much further about one axis.
Node fan_of(std::initializer_list<double> angles_deg) {
    Node node = pair_of(0.0, 0);
    node.sensors.clear();
    node.config.sensor_count = 0;
    for (const double angle_deg : angles_deg) {
        node.sensors.push_back(pair_of(angle_deg, 0).sensors[1]);
        node.config.sensors[node.config.sensor_count++].phase_us = 0;
    }
    return node;
}

TEST(GroupsRangingTogether, are_the_pairs_that_hang_together) {
    using Groups = std::vector<std::vector<std::size_t>>;
    EXPECT_EQ(groups_ranging_together(fan_of({})), Groups{});
    EXPECT_EQ(groups_ranging_together(fan_of({0, 40, 80})), Groups{});
    EXPECT_EQ(groups_ranging_together(fan_of({0, 20, 40, 60})), (Groups{{0, 1, 2, 3}})) << "a chain";
    EXPECT_EQ(groups_ranging_together(fan_of({0, 100, 20, 200, 120, 300})), (Groups{{0, 2}, {1, 4}}));
    EXPECT_EQ(groups_ranging_together(fan_of({0, 40, 90, 20})), (Groups{{0, 1, 3}})) << "joined by the last";
    EXPECT_EQ(groups_ranging_together(fan_of({40, 80, 0, 60, 20})), (Groups{{0, 1, 2, 3, 4}}));
}

}  // namespace
}  // namespace octoskin::rig
