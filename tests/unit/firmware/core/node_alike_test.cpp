// Registers that real parts may read otherwise than the driver writes them. What three or more parts of a
// node show alike is learnt and told once; what fewer show keeps each of them silent, and is told with
// register, written and read value.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>
#include <variant>
#include <vector>

#include "tests/support/node_rig.hpp"

namespace octoskin::node {
namespace {

using test::fleet_config;
using test::NodeRig;
using test::SensorSetup;
using wire::FaultKind;
using wire::RegisterReport;
using wire::SensorFault;
using wire::SensorState;

constexpr Microseconds kSecond{1'000'000};
constexpr std::uint16_t kDeciding = 0x47;  ///< where the pulse is; written 0x0B
constexpr std::uint16_t kOther = 0x4C;     ///< decides nothing; written 0x21

std::vector<SensorSetup> fleet(std::size_t count) {
    return std::vector<SensorSetup>(count);
}
void misread(SensorSetup& setup, std::uint16_t index, std::uint8_t value) {
    setup.part.traits.misread.push_back({.index = index, .value = value});
}

/// Of this kind, each once, since `from`.
std::set<std::uint32_t> reported(const NodeRig& rig, FaultKind kind, sim::SimTime from = {}) {
    std::set<std::uint32_t> wheres;
    for (const auto& said : rig.said()) {
        const auto* info = std::get_if<wire::NodeInfo>(&said.message);
        const auto* fault = info != nullptr ? std::get_if<wire::InfoFault>(info) : nullptr;
        if (fault != nullptr && fault->kind == kind && said.end >= from) wheres.insert(fault->where);
    }
    return wheres;
}
std::uint32_t report(std::uint8_t subject, std::uint8_t index, std::uint8_t written, std::uint8_t read) {
    return RegisterReport{.subject = subject, .index = index, .written = written, .read = read}.where();
}
void expect_all_well(NodeRig& rig, std::uint8_t count) {
    for (std::uint8_t sensor = 0; sensor < count; ++sensor) {
        EXPECT_EQ(rig.last_health(sensor)->state, SensorState::ranging) << int{sensor};
        EXPECT_EQ(rig.last_health(sensor)->fault, SensorFault::none) << int{sensor};
    }
    EXPECT_EQ(rig.said_of<wire::Heartbeat>().back().degraded_sensors, 0);
    EXPECT_EQ(rig.node().counts().withheld, 0U);
    EXPECT_EQ(rig.node().counts().suspect, 0U);
    EXPECT_EQ(reported(rig, FaultKind::register_fixed, {rig.now().us - kSecond.count()}),
              std::set<std::uint32_t>{});
}
void expect_withheld(NodeRig& rig, std::uint8_t sensor) {
    EXPECT_TRUE(rig.readings_of(sensor).empty()) << int{sensor};
    EXPECT_EQ(rig.last_health(sensor)->state, SensorState::degraded) << int{sensor};
    EXPECT_EQ(rig.last_health(sensor)->fault, SensorFault::config_mismatch) << int{sensor};
}

TEST(NodeAlike, what_all_parts_read_alike_withholds_nothing_and_is_told_once) {
    for (const std::uint16_t index : {kDeciding, kOther}) {
        std::vector<SensorSetup> setups = fleet(5);
        for (SensorSetup& setup : setups) misread(setup, index, 0x0C);
        NodeRig rig(fleet_config(5, 2), setups);
        rig.run_for(3 * kSecond);
        expect_all_well(rig, 5);
        for (std::uint8_t sensor = 0; sensor < 5; ++sensor) {
            ASSERT_FALSE(rig.readings_of(sensor).empty()) << int{sensor};
            EXPECT_LE(rig.readings_of(sensor).front().end.us, 1'200'000) << int{sensor};
        }
        const std::uint8_t written = index == kDeciding ? 0x0B : 0x21;
        EXPECT_EQ(reported(rig, FaultKind::register_alike),
                  std::set{report(3, static_cast<std::uint8_t>(index), written, 0x0C)});
    }
}

TEST(NodeAlike, several_registers_are_learnt_and_each_is_told) {
    std::vector<SensorSetup> setups = fleet(4);
    for (SensorSetup& setup : setups) {
        misread(setup, 0x47, 0x0C);
        misread(setup, 0x7C, 0x01);
        misread(setup, 0x4C, 0x20);
    }
    NodeRig rig(fleet_config(4, 1), setups);
    rig.run_for(6 * kSecond);
    expect_all_well(rig, 4);
    // As many parts as had shown it when the node looked, once in a millisecond.
    EXPECT_EQ(
        reported(rig, FaultKind::register_alike, {rig.now().us - 3 * kSecond.count()}),
        (std::set{report(4, 0x47, 0x0B, 0x0C), report(3, 0x7C, 0x00, 0x01), report(4, 0x4C, 0x21, 0x20)}));
}

// More than one part remembers at a time: what is learnt makes room for the rest.
TEST(NodeAlike, a_dozen_registers_are_learnt_one_lot_after_the_other) {
    std::vector<SensorSetup> setups = fleet(3);
    for (SensorSetup& setup : setups) {
        for (std::uint16_t index = 0x78; index <= 0x83; ++index) misread(setup, index, 0x5A);
    }
    NodeRig rig(fleet_config(3, 1), setups);
    rig.run_for(12 * kSecond);
    expect_all_well(rig, 3);
    EXPECT_EQ(reported(rig, FaultKind::register_alike).size(), 12U);
}

TEST(NodeAlike, what_one_part_reads_alone_withholds_that_one) {
    std::vector<SensorSetup> setups = fleet(5);
    misread(setups[3], kDeciding, 0x0C);
    NodeRig rig(fleet_config(5, 2), setups);
    rig.run_for(5 * kSecond);
    expect_withheld(rig, 3);
    EXPECT_EQ(reported(rig, FaultKind::register_fixed), std::set{report(3, 0x47, 0x0B, 0x0C)});
    EXPECT_TRUE(reported(rig, FaultKind::register_alike).empty());
    for (const std::uint8_t sensor : std::to_array<std::uint8_t>({0, 1, 2, 4}))
        EXPECT_GT(rig.readings_of(sensor).size(), 130U);
    EXPECT_EQ(rig.said_of<wire::Heartbeat>().back().degraded_sensors, 1);
}

TEST(NodeAlike, two_parts_alike_are_two_parts_that_are_withheld) {
    std::vector<SensorSetup> setups = fleet(5);
    misread(setups[1], kDeciding, 0x0C);
    misread(setups[4], kDeciding, 0x0C);
    NodeRig rig(fleet_config(5, 2), setups);
    rig.run_for(5 * kSecond);
    expect_withheld(rig, 1);
    expect_withheld(rig, 4);
    EXPECT_EQ(reported(rig, FaultKind::register_fixed),
              (std::set{report(1, 0x47, 0x0B, 0x0C), report(4, 0x47, 0x0B, 0x0C)}));
    EXPECT_TRUE(reported(rig, FaultKind::register_alike).empty());
}

TEST(NodeAlike, three_of_five_teach_the_node_and_the_others_are_still_verified) {
    std::vector<SensorSetup> setups = fleet(5);
    for (const std::size_t sensor : {0U, 2U, 4U}) misread(setups[sensor], kDeciding, 0x0C);
    misread(setups[1], kDeciding, 0x0D);  // alone with it
    NodeRig rig(fleet_config(5, 2), setups);
    rig.run_for(5 * kSecond);
    for (const std::uint8_t sensor : std::to_array<std::uint8_t>({0, 2, 3, 4})) {
        EXPECT_GT(rig.readings_of(sensor).size(), 100U) << int{sensor};
        EXPECT_EQ(rig.last_health(sensor)->fault, SensorFault::none) << int{sensor};
    }
    expect_withheld(rig, 1);
    EXPECT_EQ(reported(rig, FaultKind::register_alike), std::set{report(3, 0x47, 0x0B, 0x0C)});
    EXPECT_EQ(rig.said_of<wire::Heartbeat>().back().degraded_sensors, 1);
}

TEST(NodeAlike, one_register_with_a_value_of_its_own_on_each_part_is_alike_on_none) {
    std::vector<SensorSetup> setups = fleet(4);
    for (std::size_t i = 0; i < 4; ++i) misread(setups[i], kDeciding, static_cast<std::uint8_t>(0x10 + i));
    NodeRig rig(fleet_config(4, 1), setups);
    rig.run_for(5 * kSecond);
    for (std::uint8_t sensor = 0; sensor < 4; ++sensor) expect_withheld(rig, sensor);
    EXPECT_EQ(reported(rig, FaultKind::register_fixed).size(), 4U);
    EXPECT_TRUE(reported(rig, FaultKind::register_alike).empty());
}

TEST(NodeAlike, two_groups_with_two_values_are_both_learnt) {
    std::vector<SensorSetup> setups = fleet(6);
    for (std::size_t i = 0; i < 6; ++i) misread(setups[i], kDeciding, i % 2 == 0 ? 0x0C : 0x0D);
    NodeRig rig(fleet_config(6, 2), setups);
    rig.run_for(4 * kSecond);
    expect_all_well(rig, 6);
    EXPECT_EQ(reported(rig, FaultKind::register_alike).size(), 2U);
}

// Two are withheld, with attempts ever further apart, until a third is plugged in.
TEST(NodeAlike, parts_that_were_withheld_range_at_once_when_a_third_has_shown_the_same) {
    std::vector<SensorSetup> setups = fleet(3);
    for (SensorSetup& setup : setups) misread(setup, kDeciding, 0x0C);
    setups[2].faults.is_absent = true;
    NodeRig rig(fleet_config(3, 1), setups);
    rig.run_for(40 * kSecond);
    expect_withheld(rig, 0);
    expect_withheld(rig, 1);
    rig.sensor(2).set_faults({});
    sim::SimTime learnt{};
    while (learnt.us == 0 && rig.now().us < 90'000'000) {
        rig.run_for(Microseconds{10'000});
        if (!reported(rig, FaultKind::register_alike).empty()) learnt = rig.now();
    }
    // It is tried every 10 s by then, and shows it at three attempts.
    ASSERT_GT(learnt.us, 0);
    EXPECT_LE(learnt.us, 75'000'000);
    rig.run_for(1 * kSecond);
    for (std::uint8_t sensor = 0; sensor < 2; ++sensor) {
        ASSERT_FALSE(rig.readings_of(sensor).empty());
        EXPECT_LE(rig.readings_of(sensor).front().end.us, learnt.us + 500'000);
    }
    rig.run_for(1 * kSecond);
    expect_all_well(rig, 3);
}

// Right after each initialising, and otherwise as soon as the part ranges: as a block that the part's own
// firmware copies about.
TEST(NodeAlike, a_difference_that_appears_while_ranging_is_learnt_as_well) {
    constexpr std::uint8_t kCount = 4;
    NodeRig rig(fleet_config(kCount, 1), fleet(kCount));
    for (int i = 0; i < 2'000; ++i) {
        rig.run_for(Microseconds{10'000});
        for (std::uint8_t sensor = 0; sensor < kCount; ++sensor) {
            const auto& registers = rig.sensor(sensor).registers();
            if (registers.at(0x87) == 0x40 && registers.at(0x6E) != 0x0F)
                rig.sensor(sensor).alter_register(0x7E, 3);
        }
    }
    EXPECT_EQ(reported(rig, FaultKind::register_alike).size(), 1U);
    const std::uint32_t restarts = rig.node().counts().sensor_restarts;
    EXPECT_LE(restarts, 4U * kCount);
    for (std::uint8_t sensor = 0; sensor < kCount; ++sensor) {
        EXPECT_EQ(rig.last_health(sensor)->state, SensorState::ranging);
        EXPECT_GT(rig.readings_of(sensor).size(), 400U);
    }
}

TEST(NodeAlike, a_part_that_is_fitted_alone_is_withheld_and_ranges_once_the_rig_leaves_the_register_out) {
    std::vector<SensorSetup> setups = fleet(1);
    misread(setups[0], kDeciding, 0x0C);
    NodeConfig config = fleet_config(1, 1);
    NodeRig strict(config, setups);
    strict.run_for(3 * kSecond);
    expect_withheld(strict, 0);
    EXPECT_EQ(reported(strict, FaultKind::register_fixed), std::set{report(0, 0x47, 0x0B, 0x0C)});

    config.left_out_count = 1;
    config.left_out[0] = 0x47;
    NodeRig rig(config, setups);
    rig.run_for(3 * kSecond);
    expect_all_well(rig, 1);
    EXPECT_LE(rig.readings_of(0).front().end.us, 350'000);
    EXPECT_EQ(rig.node().counts().sensor_restarts, 0U);
    EXPECT_TRUE(reported(rig, FaultKind::register_alike).empty());
    rig.sensor(0).alter_register(0x60, 0x0B);
    rig.run_for(1 * kSecond);
    EXPECT_EQ(rig.node().counts().sensor_restarts, 1U) << "any other is verified as before";
}

TEST(NodeAlike, nothing_is_read_back_where_the_rig_switches_it_off) {
    std::vector<SensorSetup> setups = fleet(2);
    for (std::uint16_t index = 0x2D; index <= 0x85; ++index) {
        if (index != 0x30 && index != 0x31) misread(setups[0], index, 0xA5);
    }
    NodeConfig config = fleet_config(2, 1);
    config.verifies_registers = false;
    config.sensors[1].zone_count = 2;
    config.sensors[1].inter_measurement_ms = 50;
    config.sensors[1].zones[1] = {.centre_spad = 167, .width = 8, .height = 8};
    NodeRig rig(config, setups);
    rig.run_for(3 * kSecond);
    expect_all_well(rig, 2);
    EXPECT_EQ(rig.node().counts().sensor_restarts, 0U);
    EXPECT_EQ(rig.node().counts().i2c_errors, 0U);
}

// Nothing but the zone's own write says what its registers should hold.
TEST(NodeAlike, zones_are_cycled_on_parts_that_read_the_zones_register_alike) {
    NodeConfig config = fleet_config(3, 1);
    for (std::size_t i = 0; i < 3; ++i) {
        config.sensors[i].inter_measurement_ms = 60;
        config.sensors[i].zone_count = 2;
        config.sensors[i].zones[1] = {.centre_spad = 167, .width = 8, .height = 8};
    }
    std::vector<SensorSetup> setups = fleet(3);
    for (SensorSetup& setup : setups) misread(setup, 0x7F, 0x11);
    NodeRig rig(config, setups);
    rig.run_for(5 * kSecond);
    expect_all_well(rig, 3);
    for (std::uint8_t sensor = 0; sensor < 3; ++sensor) {
        std::array<int, 2> seen{};
        for (const auto& said : rig.readings_of(sensor)) ++seen.at(said.reading.zone);
        EXPECT_GT(seen[0], 20);
        EXPECT_GT(seen[1], 20);
    }
}

TEST(NodeAlike, a_register_that_changes_all_the_time_is_named_with_its_last_value) {
    NodeRig rig(fleet_config(1, 1), fleet(1));
    // Just before it is read back, and each time another value.
    for (int i = 0; i < 3'000; ++i) {
        rig.run_for(Microseconds{1'000});
        rig.sensor(0).alter_register(0x50, static_cast<std::uint8_t>(0x80 + i % 7));
    }
    const auto reports = reported(rig, FaultKind::register_fixed);
    ASSERT_FALSE(reports.empty());
    for (const std::uint32_t where : reports) EXPECT_EQ(RegisterReport::of(where).index, 0x50);
}

}  // namespace
}  // namespace octoskin::node
