// A sensor whose registers are not what was written to them: found, put right, and the readings that rested
// on them counted; and one that will not take its configuration is named, never tried for ever.
#include <gtest/gtest.h>

#include <algorithm>
#include <variant>
#include <vector>

#include "firmware/core/steering_checks.hpp"
#include "tests/support/node_rig.hpp"

namespace octoskin::node {
namespace {

using test::fleet_config;
using test::NodeRig;
using test::SensorSetup;
using wire::SensorFault;
using wire::SensorState;

constexpr Microseconds kSecond{1'000'000};
constexpr Microseconds kPeriod{33'000};

TEST(SteeringChecks, every_group_is_checked_within_ten_readings) {
    const Policy policy;
    SteeringChecks checks(policy);
    std::vector<int> since(vl53l1x::kSteeringGroups, 0);
    for (int reading = 0; reading < 100; ++reading) {
        checks.on_reading();
        for (int& count : since) EXPECT_LE(++count, 10) << reading;
        if (!checks.is_due()) continue;
        EXPECT_EQ(checks.suspects(), static_cast<std::uint32_t>(since[checks.group()])) << reading;
        since[checks.group()] = 0;
        checks.on_clean();
    }
    checks.restart();
    EXPECT_EQ(checks.suspects(), 0U);
    EXPECT_FALSE(checks.is_due());
}

class NodeReadBackTest : public testing::Test {
  protected:
    NodeReadBackTest() : rig_(fleet_config(2, 1), std::vector<SensorSetup>(2)) { rig_.run_for(2 * kSecond); }
    std::size_t readings_since(std::uint8_t sensor, sim::SimTime time) {
        const auto readings = rig_.readings_of(sensor);
        return static_cast<std::size_t>(std::count_if(readings.begin(), readings.end(),
                                                      [=](const auto& said) { return said.end >= time; }));
    }
    NodeRig rig_;
};

TEST_F(NodeReadBackTest, nothing_is_found_where_nothing_is_wrong) {
    EXPECT_EQ(rig_.node().counts().suspect, 0U);
    EXPECT_EQ(rig_.node().counts().sensor_restarts, 0U);
    EXPECT_EQ(rig_.node().counts().i2c_errors, 0U);
}

TEST_F(NodeReadBackTest, every_steering_register_that_changes_is_put_right_and_its_readings_counted) {
    std::vector<std::uint16_t> steering{0x69};
    const auto add = [&](std::uint16_t first, std::uint16_t last) {
        for (std::uint16_t index = first; index <= last; ++index) steering.push_back(index);
    };
    add(0x1E, 0x23);
    add(0x5E, 0x63);
    add(0x6E, 0x6F);  // higher bytes of the period make the sensor silent
    add(0x78, 0x7B);
    add(0x7F, 0x80);
    for (const std::uint16_t index : steering) {
        const NodeCounts before = rig_.node().counts();
        const std::uint8_t good = rig_.sensor(0).registers().at(index);
        const sim::SimTime altered = rig_.now();
        rig_.sensor(0).alter_register(index, good ^ 0x01U);
        // Ten readings, and what recovery takes.
        rig_.run_for(10 * kPeriod + Microseconds{10'000});
        EXPECT_EQ(rig_.node().counts().sensor_restarts, before.sensor_restarts + 1) << index;
        const std::size_t sent = readings_since(0, altered);
        const std::uint32_t suspect = rig_.node().counts().suspect - before.suspect;
        EXPECT_GE(suspect, sent) << index;
        EXPECT_LE(suspect, 10U) << index;
        rig_.run_for(1 * kSecond);
        EXPECT_EQ(rig_.sensor(0).registers().at(index), good) << index;
        EXPECT_EQ(rig_.last_health(0)->state, SensorState::ranging) << index;
        EXPECT_EQ(rig_.last_health(0)->fault, SensorFault::config_mismatch) << index;
        EXPECT_EQ(rig_.node().counts().sensor_restarts, before.sensor_restarts + 1) << index;
    }
    EXPECT_EQ(rig_.said_of<wire::Heartbeat>().back().degraded_sensors, 0);
    EXPECT_EQ(rig_.last_health(1)->fault, SensorFault::none) << "its neighbour";
    EXPECT_GT(rig_.readings_of(1).size(), 30 * steering.size());
}

TEST_F(NodeReadBackTest, a_bit_flipped_in_the_check_itself_costs_nothing) {
    for (std::uint64_t i = 0; i < 400; ++i) {
        rig_.bus(0).inject({.kind = sim::I2cFaultKind::flip_bit,
                            .first = rig_.bus(0).transfer_count() + 17 * i,
                            .position = static_cast<std::uint32_t>(i % 40)});
    }
    rig_.run_for(20 * kSecond);
    EXPECT_EQ(rig_.node().counts().suspect, 0U);
    for (const wire::SensorHealth& health : rig_.said_of<wire::SensorHealth>())
        EXPECT_NE(health.fault, SensorFault::config_mismatch);
}

TEST(NodeReadBack, a_configuration_write_lost_at_the_start_costs_one_more_attempt) {
    NodeRig clean(fleet_config(1, 1), std::vector<SensorSetup>(1));
    clean.run_for(Microseconds{150'000});
    const std::uint64_t transfers = clean.bus(0).transfer_count();
    std::uint32_t restarts = 0;
    for (std::uint64_t i = 0; i < transfers; ++i) {
        NodeRig rig(fleet_config(1, 1), std::vector<SensorSetup>(1));
        rig.bus(0).inject({.kind = sim::I2cFaultKind::lose_write, .first = i});
        rig.run_for(2 * kSecond);
        EXPECT_EQ(rig.last_health(0)->state, SensorState::ranging) << i;
        EXPECT_EQ(rig.sensor(0).registers().at(0x5F), clean.sensor(0).registers().at(0x5F)) << i;
        EXPECT_EQ(rig.sensor(0).registers().at(0x69), clean.sensor(0).registers().at(0x69)) << i;
        EXPECT_LE(rig.node().counts().sensor_restarts, 1U) << i;
        EXPECT_EQ(rig.node().counts().suspect, 0U) << i;
        restarts += rig.node().counts().sensor_restarts;
    }
    EXPECT_GT(restarts, 8U) << "the faults hardly did anything";
}

TEST(NodeReadBack, a_register_that_never_takes_its_value_is_tried_three_times_then_named) {
    std::vector<SensorSetup> setups(1);
    setups[0].faults.stuck_register = sim::StuckRegister{.index = 0x4C, .value = 0x20};
    NodeRig rig(fleet_config(1, 1), setups);
    rig.run_for(20 * kSecond);
    EXPECT_EQ(rig.node().counts().sensor_restarts, 2U);
    EXPECT_EQ(rig.last_health(0)->state, SensorState::ranging);
    EXPECT_EQ(rig.last_health(0)->fault, SensorFault::config_mismatch);
    EXPECT_EQ(rig.said_of<wire::Heartbeat>().back().degraded_sensors, 1) << "not as configured";
    EXPECT_GT(rig.readings_of(0).size(), 500U);
    EXPECT_EQ(rig.node().counts().suspect, 0U) << "it does not steer the range";
    const auto pages = rig.said_of<wire::NodeInfo>();
    const auto named = std::find_if(pages.rbegin(), pages.rend(), [](const wire::NodeInfo& page) {
        return std::holds_alternative<wire::InfoFault>(page);
    });
    ASSERT_NE(named, pages.rend());
    EXPECT_EQ(std::get<wire::InfoFault>(*named).kind, wire::FaultKind::register_fixed);
    EXPECT_EQ(std::get<wire::InfoFault>(*named).where, 0x00'004C'20U) << "sensor 0, 0x4C holds 0x20";
}

TEST(NodeReadBack, readings_on_a_steering_register_that_will_not_take_its_value_stay_suspect) {
    std::vector<SensorSetup> setups(1);
    setups[0].faults.stuck_register = sim::StuckRegister{.index = 0x79, .value = 0x0C};
    NodeRig rig(fleet_config(1, 1), setups);
    rig.run_for(5 * kSecond);
    EXPECT_EQ(rig.node().counts().sensor_restarts, 2U);
    EXPECT_GT(rig.readings_of(0).size(), 100U);
    EXPECT_EQ(rig.node().counts().suspect, rig.readings_of(0).size());
}

// It is right after each initialising and wrong as soon as the part ranges.
TEST(NodeReadBack, a_part_that_alters_a_register_while_ranging_is_not_initialised_for_ever) {
    NodeRig rig(fleet_config(1, 1), std::vector<SensorSetup>(1));
    for (int i = 0; i < 3'000; ++i) {
        rig.run_for(Microseconds{10'000});
        if (rig.last_health(0) && rig.last_health(0)->state == SensorState::ranging)
            rig.sensor(0).alter_register(0x7E, 0x03);
    }
    EXPECT_EQ(rig.node().counts().sensor_restarts, 2U);
    EXPECT_EQ(rig.said_of<wire::Heartbeat>().back().degraded_sensors, 1);
    EXPECT_GT(rig.readings_of(0).size(), 800U);
}

}  // namespace
}  // namespace octoskin::node
