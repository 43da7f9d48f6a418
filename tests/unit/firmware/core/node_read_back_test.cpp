// A sensor whose registers are not what was written to them: found, put right, and the readings that rested
// on them counted; and one that will not take its configuration is named, never tried for ever.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
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

wire::InfoFault last_fault(const NodeRig& rig) {
    wire::InfoFault last;
    for (const wire::NodeInfo& page : rig.said_of<wire::NodeInfo>()) {
        if (const auto* fault = std::get_if<wire::InfoFault>(&page)) last = *fault;
    }
    return last;
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
    std::uint32_t suspects = 0;
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
        suspects += suspect;
        rig_.run_for(1 * kSecond);
        EXPECT_EQ(rig_.sensor(0).registers().at(index), good) << index;
        EXPECT_EQ(rig_.last_health(0)->state, SensorState::ranging) << index;
        EXPECT_EQ(rig_.last_health(0)->fault, SensorFault::config_mismatch) << index;
        EXPECT_EQ(rig_.node().counts().sensor_restarts, before.sensor_restarts + 1) << index;
    }
    EXPECT_GT(suspects, 3 * steering.size()) << "readings were sent before it was found";
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
    EXPECT_GT(rig_.node().counts().i2c_errors, 10U) << "checks that a second one contradicted";
    EXPECT_EQ(rig_.node().counts().suspect, 0U);
    for (const wire::SensorHealth& health : rig_.said_of<wire::SensorHealth>())
        EXPECT_NE(health.fault, SensorFault::config_mismatch);
}

TEST(NodeReadBack, a_configuration_write_lost_at_the_start_costs_one_more_attempt) {
    NodeRig clean(fleet_config(1, 1), std::vector<SensorSetup>(1));
    clean.run_for(Microseconds{400'000});
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

// The factory's offset, which the node writes nowhere: nothing but its first read tells what it should be.
TEST(NodeReadBack, no_write_of_a_bring_up_that_arrives_at_the_factory_offset_stays_there) {
    NodeRig clean(fleet_config(1, 1), std::vector<SensorSetup>(1));
    // Started, and not for the one range of its bring-up, whose period is the default's.
    const auto& registers = clean.sensor(0).registers();
    while (registers.at(0x87) != 0x40 || registers.at(0x6E) == 0x0F) clean.run_for(Microseconds{100});
    // Not of the bring-up: oscillator twice, period, its read-back, clear, start. What goes astray there is
    // found as whatever changes while ranging.
    const std::uint64_t transfers = clean.bus(0).transfer_count() - 6;
    const auto offset_of = [](NodeRig& rig) {
        const auto first = rig.sensor(0).registers().begin() + 0x1E;
        return std::vector<std::uint8_t>(first, first + 6);
    };
    std::size_t hits = 0;
    for (const std::uint32_t index : {0x1EU, 0x1FU, 0x20U, 0x23U}) {
        for (std::uint64_t i = 0; i < transfers; ++i) {
            NodeRig rig(fleet_config(1, 1), std::vector<SensorSetup>(1));
            rig.bus(0).inject({.kind = sim::I2cFaultKind::redirect_write, .first = i, .position = index});
            bool is_hit = false;
            while (rig.readings_of(0).empty() && rig.now().us < 2'000'000) {
                rig.run_for(Microseconds{1'000});
                is_hit = is_hit || offset_of(rig) != offset_of(clean);
            }
            if (is_hit) ++hits;
            EXPECT_EQ(offset_of(rig), offset_of(clean)) << index << " from transfer " << i;
            EXPECT_FALSE(rig.readings_of(0).empty()) << index << " from transfer " << i;
            EXPECT_LE(rig.node().counts().sensor_restarts, 1U) << index << " from transfer " << i;
            EXPECT_EQ(rig.node().counts().suspect, 0U) << index << " from transfer " << i;
        }
    }
    EXPECT_GT(hits, 4U * 20U) << "the faults hardly did anything";
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
    EXPECT_EQ(rig.node().counts().withheld, 0U) << "it does not decide the range";
    EXPECT_EQ(rig.node().counts().suspect, rig.node().counts().accepted) << "but nobody knows what it does";
    EXPECT_EQ(last_fault(rig).kind, wire::FaultKind::register_fixed);
    EXPECT_EQ(last_fault(rig).where, 0x00'4C'21'20U) << "sensor 0, 0x4C was written 0x21 and reads 0x20";
}

// One of each group of steering registers, the crosstalk, and what lies outside the groups: offset, budget,
// VCSEL period, signal limit, valid phase, inter-measurement period, window, phase, centre, size, sequence.
TEST(NodeReadBack, no_reading_is_sent_on_a_register_that_decides_the_range_and_will_not_take_its_value) {
    constexpr std::array<std::uint16_t, 14> kDeciding{0x1E, 0x5F, 0x60, 0x66, 0x69, 0x6F, 0x79,
                                                      0x7A, 0x7F, 0x80, 0x81, 0x16, 0x4B, 0x4F};
    for (const std::uint16_t index : kDeciding) {
        std::vector<SensorSetup> setups(2);
        setups[0].faults.stuck_register = sim::StuckRegister{.index = index, .value = 0x2A};
        NodeConfig config = fleet_config(2, 1);
        config.sensors[0].has_offset = true;
        NodeRig rig(config, setups);
        rig.run_for(12 * kSecond);
        EXPECT_TRUE(rig.readings_of(0).empty()) << index;
        EXPECT_GT(rig.readings_of(1).size(), 300U) << "its neighbour";
        EXPECT_EQ(rig.last_health(0)->state, SensorState::degraded) << index;
        EXPECT_EQ(rig.last_health(0)->fault, SensorFault::config_mismatch) << index;
        EXPECT_EQ(rig.said_of<wire::Heartbeat>().back().degraded_sensors, 1);
        EXPECT_EQ(last_fault(rig).kind, wire::FaultKind::register_fixed) << index;
        const auto reported = wire::RegisterReport::of(last_fault(rig).where);
        EXPECT_EQ(reported.subject, 0);
        EXPECT_EQ(reported.index, index);
        EXPECT_NE(reported.written, 0x2A) << index;
        EXPECT_EQ(reported.read, 0x2A) << index;
        // At once, then after 0.1, 0.2, ... 6.4 s.
        EXPECT_LE(rig.node().counts().sensor_restarts, 9U) << index;
    }
}

TEST(NodeReadBack, a_part_whose_register_takes_its_value_again_ranges_again_after_a_probation) {
    std::vector<SensorSetup> setups(1);
    setups[0].faults.stuck_register = sim::StuckRegister{.index = 0x7F, .value = 0x2A};
    NodeRig rig(fleet_config(1, 1), setups);
    rig.run_for(5 * kSecond);
    rig.sensor(0).set_faults({});
    rig.run_for(10 * kSecond);
    EXPECT_TRUE(rig.readings_of(0).empty()) << "not at the first good sign";
    EXPECT_GT(rig.node().counts().withheld, 50U);
    EXPECT_EQ(rig.node().counts().rejected, rig.node().counts().withheld);
    EXPECT_EQ(rig.last_health(0)->state, SensorState::degraded);
    rig.run_for(10 * kSecond);
    EXPECT_GT(rig.readings_of(0).size(), 100U);
    EXPECT_EQ(rig.last_health(0)->state, SensorState::ranging);
    EXPECT_EQ(rig.said_of<wire::Heartbeat>().back().degraded_sensors, 0);
    EXPECT_EQ(last_fault(rig).kind, wire::FaultKind::none);
    EXPECT_EQ(rig.node().counts().suspect, 0U);
}

// It is right after each initialising and wrong as soon as the part ranges.
TEST(NodeReadBack, a_part_that_alters_its_quantifier_while_ranging_is_seen_through_after_three_times) {
    NodeRig rig(fleet_config(1, 1), std::vector<SensorSetup>(1));
    std::size_t sent_at_third = 0;
    for (int i = 0; i < 3'000; ++i) {
        rig.run_for(Microseconds{10'000});
        // Started, and not for the one range of its bring-up, whose period is the default's.
        const auto& registers = rig.sensor(0).registers();
        if (registers.at(0x87) == 0x40 && registers.at(0x6E) != 0x0F) rig.sensor(0).alter_register(0x7E, 3);
        if (rig.node().counts().sensor_restarts == 3 && sent_at_third == 0)
            sent_at_third = rig.readings_of(0).size();
    }
    EXPECT_LE(rig.readings_of(0).size(), 3U * 10U);
    EXPECT_GE(sent_at_third, 3U) << "found while it ranged, three times";
    EXPECT_EQ(rig.readings_of(0).size(), sent_at_third) << "none after the third time";
    EXPECT_EQ(rig.node().counts().suspect, rig.readings_of(0).size());
    EXPECT_GT(rig.node().counts().withheld, 10U);
    EXPECT_LE(rig.node().counts().sensor_restarts, 12U);
    EXPECT_EQ(rig.last_health(0)->state, SensorState::degraded);
    EXPECT_EQ(rig.said_of<wire::Heartbeat>().back().degraded_sensors, 1);
}

}  // namespace
}  // namespace octoskin::node
