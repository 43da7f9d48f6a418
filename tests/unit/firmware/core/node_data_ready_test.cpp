// A node whose buses have data-ready lines, whole and broken. Oracle: the same node without them.
#include <gtest/gtest.h>

#include <array>
#include <string>

#include "tests/support/node_rig.hpp"

namespace octoskin::node {
namespace {

using namespace std::chrono_literals;
using sim::LineFault;
using test::fleet_config;
using test::NodeRig;
using test::SaidReading;
using test::SensorSetup;

constexpr std::uint8_t kSensors = 6;

NodeConfig config_with(std::uint8_t data_ready_buses) {
    NodeConfig config = fleet_config(kSensors, 2);
    config.data_ready_buses = data_ready_buses;
    return config;
}

std::vector<SensorSetup> parts() {
    std::vector<SensorSetup> setups(kSensors);
    for (std::size_t i = 0; i < kSensors; ++i)
        setups[i].part.slow_clock_factor = 1.0 + 0.03 * static_cast<double>(i);
    return setups;
}

/// Everything about the readings of all sensors, times included.
std::string inputs_of(const NodeRig& rig) {
    std::string text;
    for (std::uint8_t sensor = 0; sensor < kSensors; ++sensor) {
        for (const SaidReading& said : rig.readings_of(sensor)) {
            const auto& reading = said.reading;
            text += std::to_string(reading.range_mm) + ' ' + std::to_string(reading.capture.value_us) + ' ' +
                    std::to_string(reading.sequence) + ' ' + std::to_string(said.end.us) + '\n';
        }
    }
    return text;
}

std::uint64_t polls_of(NodeRig& rig, std::uint8_t sensor) {
    return rig.sensor(sensor).poll_count();
}

double polls_per_reading(NodeRig& rig) {
    std::uint64_t polls = 0;
    for (std::uint8_t sensor = 0; sensor < kSensors; ++sensor) polls += polls_of(rig, sensor);
    return static_cast<double>(polls) / rig.node().counts().accepted;
}

std::uint8_t ignored_bus_reported(const NodeRig& rig) {
    std::uint8_t reported = 255;
    for (const wire::NodeInfo& info : rig.said_of<wire::NodeInfo>()) {
        const auto* fault = std::get_if<wire::InfoFault>(&info);
        if (fault != nullptr && fault->kind == wire::FaultKind::data_ready_ignored)
            reported = static_cast<std::uint8_t>(fault->where);
    }
    return reported;
}

TEST(NodeDataReady, saves_polls_of_the_bus_that_has_a_line_and_of_no_other) {
    NodeRig without(config_with(0), parts());
    NodeRig with(config_with(0b10), parts());
    std::array<std::array<std::uint64_t, kSensors>, 2> before{};
    without.run_for(1500ms);  // up and trimmed
    with.run_for(1500ms);
    for (std::uint8_t sensor = 0; sensor < kSensors; ++sensor)
        before[0][sensor] = polls_of(without, sensor), before[1][sensor] = polls_of(with, sensor);
    without.run_for(2s);
    with.run_for(2s);
    for (std::uint8_t sensor = 0; sensor < kSensors; ++sensor) {
        const std::uint64_t usual = polls_of(without, sensor) - before[0][sensor];
        const std::uint64_t polls = polls_of(with, sensor) - before[1][sensor];
        if (config_with(0).sensors[sensor].bus == 1) {
            EXPECT_LT(polls, usual * 19 / 20) << int{sensor};
        } else {
            EXPECT_GE(polls, usual * 9 / 10) << int{sensor};
        }
    }
    EXPECT_EQ(with.data_ready().asked_count(0), 0U);
    EXPECT_NEAR(with.node().counts().accepted, without.node().counts().accepted, 6.0);
    EXPECT_EQ(with.node().ignored_data_ready(), 0);
}

class SilentLine : public testing::TestWithParam<LineFault> {};

TEST_P(SilentLine, changes_nothing_to_the_microsecond) {
    NodeRig without(config_with(0), parts());
    NodeRig with(config_with(0b11), parts());
    for (const std::size_t bus : {0U, 1U}) with.data_ready().line(bus).set_fault(GetParam());
    without.run_for(3s);
    with.run_for(3s);
    EXPECT_GT(inputs_of(with).size(), 5'000U);
    EXPECT_EQ(inputs_of(with), inputs_of(without));
    EXPECT_EQ(polls_per_reading(with), polls_per_reading(without));
    EXPECT_EQ(with.node().counts().spurious_hints, 0U);
}
INSTANTIATE_TEST_SUITE_P(Faults, SilentLine, testing::Values(LineFault::stuck_low, LineFault::stuck_high));

TEST(NodeDataReady, line_that_gets_stuck_while_at_work_is_no_longer_waited_for) {
    for (const LineFault fault : {LineFault::stuck_low, LineFault::stuck_high}) {
        NodeRig rig(config_with(0b11), parts());
        rig.run_for(3s);
        const std::uint32_t before = rig.node().counts().accepted;
        for (const std::size_t bus : {0U, 1U}) rig.data_ready().line(bus).set_fault(fault);
        rig.run_for(3s);
        EXPECT_NEAR(rig.node().counts().accepted - before, 6 * 3000.0 / 33.0, 12.0);
        EXPECT_EQ(rig.node().counts().rejected + rig.node().counts().sensor_restarts, 0U);
        for (const std::size_t bus : {0U, 1U}) rig.data_ready().line(bus).set_fault(LineFault::none);
        const double polls = polls_per_reading(rig);
        rig.run_for(3s);
        EXPECT_LT(polls_per_reading(rig), polls) << "and is used again once it works";
    }
}

TEST(NodeDataReady, line_that_chatters_is_given_up_and_told_and_costs_no_reading) {
    NodeRig without(config_with(0), parts());
    NodeRig rig(config_with(0b11), parts());
    rig.data_ready().line(1).set_fault(LineFault::chatters);
    without.run_for(2s);
    rig.run_for(2s);
    EXPECT_EQ(rig.node().ignored_data_ready(), 0b10) << "and the other line is at work";
    EXPECT_EQ(ignored_bus_reported(rig), 1);
    EXPECT_LE(rig.data_ready().asked_count(1), 2'000'000U / 250U);
    EXPECT_NEAR(rig.node().counts().accepted, without.node().counts().accepted, 6.0);
    EXPECT_EQ(rig.node().counts().rejected + rig.node().counts().sensor_restarts, 0U);
    EXPECT_GE(rig.node().counts().spurious_hints, 100U);
    // What the noise cost until then: a poll more per sensor of the bus and hint, at most.
    for (const auto sensor : std::to_array<std::uint8_t>({1, 3, 5}))
        EXPECT_LE(polls_of(rig, sensor), polls_of(without, sensor) + 400) << int{sensor};
}

TEST(NodeDataReady, line_that_begins_to_chatter_while_at_work_costs_no_reading_either) {
    NodeRig rig(config_with(0b11), parts());
    rig.run_for(2s);
    EXPECT_EQ(ignored_bus_reported(rig), 255);
    const std::uint32_t before = rig.node().counts().accepted;
    rig.data_ready().line(0).set_fault(LineFault::chatters);
    rig.run_for(2s);
    EXPECT_EQ(rig.node().ignored_data_ready(), 0b01);
    EXPECT_EQ(ignored_bus_reported(rig), 0);
    EXPECT_NEAR(rig.node().counts().accepted - before, 6 * 2000.0 / 33.0, 12.0);
    EXPECT_EQ(rig.node().counts().rejected + rig.node().counts().sensor_restarts, 0U);
}

TEST(NodeDataReady, sensor_that_never_clears_its_pin_takes_the_line_but_not_its_neighbours_readings) {
    std::vector<SensorSetup> setups = parts();
    setups[2].faults.is_always_ready = true;  // sensors 0, 2 and 4 share bus 0
    NodeRig rig(config_with(0b11), setups);
    rig.run_for(3s);
    for (const auto sensor : std::to_array<std::uint8_t>({0, 1, 3, 4, 5}))
        EXPECT_NEAR(static_cast<double>(rig.readings_of(sensor).size()), 2750.0 / 33.0, 12.0) << int{sensor};
}

}  // namespace
}  // namespace octoskin::node
