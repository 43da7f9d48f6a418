// I7, I8, I10: sensors that lose their supply, do not obey their reset line, or stop measuring. Which test
// shows which row: docs/reference/reliability.md.
#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "tests/sim/reliability/six_sensors.hpp"

namespace octoskin::test {
namespace {

using wire::SensorFault;
using wire::SensorState;

using SensorLossTest = SixSensorsTest;

TEST_P(SensorLossTest, I7_one_sensor_that_browned_out_is_back_within_the_figure) {
    rig_.sensor(kHurt).brown_out(rig_.now());
    rig_.run_for(2 * kSecond);
    EXPECT_LE(longest_gap_us(rig_, kHurt, hurt_us_), kReinitialisedUs);
    expect_neighbours_undisturbed();
    expect_all_range();
}

TEST_P(SensorLossTest, I7_all_sensors_that_browned_out_together_are_back_within_the_figure) {
    for (std::size_t sensor = 0; sensor < kSensors; ++sensor) rig_.sensor(sensor).brown_out(rig_.now());
    rig_.run_for(2 * kSecond);
    for (std::uint8_t sensor = 0; sensor < kSensors; ++sensor) {
        EXPECT_LE(longest_gap_us(rig_, sensor, hurt_us_), kReinitialisedUs) << int{sensor};
    }
    expect_all_range();
}

TEST(ReliabilityI8, xshut_stuck_low_makes_that_sensor_absent_by_name_and_no_other) {
    std::vector<SensorSetup> setups(3);
    setups[1].is_fitted = false;  // never leaves reset: the same to whoever looks from the bus
    NodeRig rig(fleet_config(3, 1), setups);
    rig.run_for(2 * kSecond);
    EXPECT_EQ(rig.last_health(1)->state, SensorState::absent);
    EXPECT_EQ(rig.last_health(1)->fault, SensorFault::no_answer);
    for (const std::uint8_t sensor : std::array<std::uint8_t, 2>{0, 2}) {
        EXPECT_EQ(rig.last_health(sensor)->state, SensorState::ranging);
    }
}

// Whichever of the bus's sensors it is: its line is named, and all others range.
TEST(ReliabilityI8, xshut_stuck_high_from_the_start_is_named_by_raising_each_in_turn) {
    for (std::uint8_t stuck = 0; stuck < 5; ++stuck) {
        std::vector<SensorSetup> setups(5);
        setups[stuck].faults.ignores_xshut = true;
        NodeRig rig(fleet_config(5, 1), setups);
        rig.sensor(stuck).set_xshut(true, rig.now());  // it has been up since power came
        rig.run_for(3 * kSecond);
        for (std::uint8_t sensor = 0; sensor < 5; ++sensor) {
            const bool is_stuck = sensor == stuck;
            EXPECT_EQ(rig.last_health(sensor)->state, is_stuck ? SensorState::absent : SensorState::ranging);
            EXPECT_EQ(rig.last_health(sensor)->fault, is_stuck ? SensorFault::xshut_stuck : SensorFault::none)
                << int{stuck} << ' ' << int{sensor};
            if (!is_stuck) expect_only_the_truth(rig, sensor);
        }
        EXPECT_EQ(last_page<wire::InfoFault>(rig)->kind, wire::FaultKind::xshut_stuck);
        EXPECT_EQ(last_page<wire::InfoFault>(rig)->where, stuck) << "the XSHUT line";
        EXPECT_EQ(rig.said_of<wire::Heartbeat>().back().degraded_sensors, 1);
    }
}

// It had its own address when its line broke; the next re-initialisation finds it there, all in reset.
TEST(ReliabilityI8, xshut_stuck_high_later_is_named_by_its_own_address_and_is_used_again_once_mended) {
    NodeRig rig(fleet_config(3, 1), std::vector<SensorSetup>(3));
    rig.run_for(2 * kSecond);  // up and trimmed
    const std::int64_t hurt_us = rig.now().us;
    rig.sensor(1).set_faults({.ignores_xshut = true, .never_ready = true});
    rig.run_for(1 * kSecond);
    EXPECT_EQ(rig.last_health(1)->fault, SensorFault::xshut_stuck);
    EXPECT_EQ(rig.last_health(1)->state, SensorState::lost);
    EXPECT_EQ(last_page<wire::InfoFault>(rig)->where, 1U);
    for (const std::uint8_t sensor : std::array<std::uint8_t, 2>{0, 2}) {
        EXPECT_LE(longest_gap_us(rig, sensor, hurt_us), 2 * kPeriodUs + 5'000);
    }
    rig.sensor(1).set_faults({});
    rig.run_for(12 * kSecond);
    EXPECT_EQ(rig.last_health(1)->state, SensorState::ranging);
    EXPECT_EQ(last_page<wire::InfoFault>(rig)->kind, wire::FaultKind::none);
    expect_only_the_truth(rig, 1);
}

// The controller starts anew while a sensor keeps its address, as its line is stuck: the address names it.
TEST(ReliabilityI8, xshut_stuck_high_over_a_reset_of_the_controller_is_named_by_its_address) {
    for (std::uint8_t stuck = 0; stuck < 3; ++stuck) {
        NodeRig rig(fleet_config(3, 1), std::vector<SensorSetup>(3));
        rig.run_for(1 * kSecond);
        rig.sensor(stuck).set_faults({.ignores_xshut = true});
        rig.reset({.cause = wire::ResetCause::pin});
        rig.run_for(2 * kSecond);
        for (std::uint8_t sensor = 0; sensor < 3; ++sensor) {
            EXPECT_EQ(rig.last_health(sensor)->fault,
                      sensor == stuck ? SensorFault::xshut_stuck : SensorFault::none)
                << int{stuck} << ' ' << int{sensor};
        }
        EXPECT_EQ(last_page<wire::InfoFault>(rig)->where, stuck);
    }
}

TEST(ReliabilityI8, a_sensor_that_dies_beside_a_stray_one_is_not_taken_for_it) {
    NodeRig rig(fleet_config(3, 1), std::vector<SensorSetup>(3));
    rig.attach_stray_sensor(0);
    rig.run_for(1 * kSecond);
    rig.sensor(1).set_faults({.is_absent = true});
    rig.run_for(2 * kSecond);
    EXPECT_EQ(rig.last_health(1)->fault, SensorFault::no_answer);
}

// I10: for 5 s; nothing is sent but first results after restarts, marked so that no host uses them.
TEST_P(SensorLossTest, I10_frozen_data_is_stale_after_three_periods_and_never_repeated) {
    rig_.sensor(kHurt).set_faults({.freezes_stream = true});
    rig_.run_for(5 * kPeriodUs * Microseconds{1});
    EXPECT_GE(rig_.node().counts().sensor_restarts, 1U);
    rig_.run_for(5 * kSecond);
    EXPECT_EQ(rig_.last_health(kHurt)->fault, SensorFault::stale_stream);
    for (const SaidReading& said : rig_.readings_of(kHurt)) {
        if (said.end.us > hurt_us_ + 60'000) {
            EXPECT_EQ(said.reading.device_status, 19);
        }
    }
    expect_only_the_truth(rig_, kHurt);
    expect_neighbours_undisturbed();
    rig_.sensor(kHurt).set_faults({});
    rig_.run_for(12 * kSecond);
    expect_all_range();
}

TEST_P(SensorLossTest, I10_a_sensor_that_is_never_ready_is_reinitialised_after_three_periods) {
    rig_.sensor(kHurt).set_faults({.never_ready = true});
    rig_.run_for(5 * kPeriodUs * Microseconds{1});
    EXPECT_GE(rig_.node().counts().sensor_restarts, 1U);
    EXPECT_EQ(rig_.last_health(kHurt)->fault, SensorFault::no_data_ready);
    const std::size_t readings = rig_.readings_of(kHurt).size();
    rig_.run_for(1 * kSecond);
    EXPECT_EQ(rig_.readings_of(kHurt).size(), readings);
    expect_neighbours_undisturbed();
}

INSTANTIATE_TEST_SUITE_P(Reliability, SensorLossTest, wraps(), wrap_name);

}  // namespace
}  // namespace octoskin::test
