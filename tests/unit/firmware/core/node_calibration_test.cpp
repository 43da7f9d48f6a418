// A sensor is calibrated by command while its neighbours range; the node answers, keeps nothing of it, and
// with what it found as configuration the sensor ranges right. The modelled optics are the oracle.
#include <gtest/gtest.h>

#include <vector>

#include "tests/unit/firmware/core/calibration_rig.hpp"

namespace octoskin::node::calibrations {
namespace {

// Reads 30 mm too far: found to a quarter of a millimetre.
TEST(NodeCalibration, finds_an_offset_with_which_the_sensor_then_ranges_right) {
    NodeRig rig(fleet_config(4, 2), setups_with(grey_target(0.170, 8.0)));
    rig.run_for(1 * kSecond);
    EXPECT_EQ(last_range_mm(rig), 170);
    const std::size_t before = rig.readings_of(0).size();
    command(rig, CommandCode::calibrate_offset, kBad, 140);
    rig.run_for(4 * kSecond);
    const auto said = rig.said_of<Calibration>();
    ASSERT_EQ(outcomes(rig), (std::vector{under_way, done}));
    const Calibration expected{.sensor = kBad,
                               .quantity = CalibrationQuantity::offset,
                               .outcome = done,
                               .sequence = 77,
                               .offset_quarter_mm = 4 * (13 - 30),
                               .crosstalk_raw = 0};
    EXPECT_EQ(said[1], expected);
    EXPECT_LT((rig.times_of<Calibration>()[0].us - 1'000'000) / 1'000, 20) << "answered at once";
    for (const std::uint8_t neighbour : std::vector<std::uint8_t>{0, 2, 3})
        EXPECT_GE(rig.readings_of(neighbour).size(), before + 4 * 30 - 2) << int{neighbour};
    EXPECT_EQ(rig.last_health(kBad)->state, SensorState::ranging);
    EXPECT_EQ(last_range_mm(rig), 170) << "as configured: nothing stays on the node";
    EXPECT_EQ(rig.node().counts().sensor_restarts, 0U);
    EXPECT_EQ(rig.node().counts().rx_rejected, 0U);

    NodeConfig mended = fleet_config(4, 2);
    mended.sensors[kBad].has_offset = true;
    mended.sensors[kBad].offset_quarter_mm = said[1].offset_quarter_mm;
    NodeRig again(mended, setups_with(grey_target(0.170, 8.0)));
    again.run_for(1 * kSecond);
    EXPECT_EQ(last_range_mm(again), 140);
}

TEST(NodeCalibration, finds_a_crosstalk_with_which_the_sensor_then_ranges_right) {
    NodeRig rig(fleet_config(4, 2), setups_with(grey_target(0.600, 4.0), 4.0));
    rig.run_for(1 * kSecond);
    EXPECT_LT(last_range_mm(rig), 500);
    command(rig, CommandCode::calibrate_crosstalk, kBad, 600);
    rig.run_for(4 * kSecond);
    ASSERT_EQ(outcomes(rig), (std::vector{under_way, done}));
    const Calibration found = rig.said_of<Calibration>()[1];
    EXPECT_EQ(found.quantity, CalibrationQuantity::crosstalk);
    EXPECT_NEAR(found.crosstalk_raw, 4.0 * 512, 18.0);
    EXPECT_EQ(found.offset_quarter_mm, 0);

    NodeConfig mended = fleet_config(4, 2);
    mended.sensors[kBad].crosstalk_raw = found.crosstalk_raw;
    NodeRig again(mended, setups_with(grey_target(0.600, 4.0), 4.0));
    again.run_for(1 * kSecond);
    EXPECT_NEAR(last_range_mm(again), 600, 1);
}

TEST(NodeCalibration, refuses_what_it_cannot_do_and_says_so) {
    NodeRig rig(fleet_config(4, 2), setups_with(grey_target(0.140, 8.0)));
    rig.run_for(1 * kSecond);
    command(rig, CommandCode::calibrate_offset, 4, 140, 1);  // there are four
    rig.run_for(kSecond / 10);
    command(rig, CommandCode::calibrate_offset, kBad, 0, 2);
    rig.run_for(kSecond / 10);
    command(rig, CommandCode::calibrate_crosstalk, kBad, 4'001, 3);
    rig.run_for(kSecond / 10);
    EXPECT_EQ(outcomes(rig), (std::vector{refused, refused, refused}));
    EXPECT_EQ(rig.said_of<Calibration>()[0].sensor, 4);
    EXPECT_EQ(rig.said_of<Calibration>()[2].quantity, CalibrationQuantity::crosstalk);
    command(rig, CommandCode::calibrate_offset, wire::kAllSensors, 140, 4);
    rig.run_for(kSecond / 10);
    EXPECT_EQ(rig.said_of<Calibration>().size(), 3U) << "all of them: whom should it name?";
    EXPECT_EQ(rig.node().counts().rx_rejected, 4U);
    command(rig, CommandCode::calibrate_offset, kBad, 4'000, 5);
    rig.run_for(kSecond / 10);
    command(rig, CommandCode::calibrate_offset, 0, 140, 6);
    rig.run_for(kSecond / 10);
    EXPECT_EQ(outcomes(rig), (std::vector{refused, refused, refused, under_way, refused}));
    rig.run_for(4 * kSecond);
    EXPECT_EQ(outcomes(rig).back(), out_of_range) << "3.86 m of offset";
    EXPECT_EQ(rig.said_of<Calibration>().back().sequence, 5);
    EXPECT_EQ(rig.last_health(kBad)->state, SensorState::ranging);
}

TEST(NodeCalibration, without_a_target_it_fails_and_the_sensor_ranges_again) {
    NodeRig rig(fleet_config(4, 2), setups_with({}));
    rig.run_for(1 * kSecond);
    command(rig, CommandCode::calibrate_offset, kBad, 140);
    rig.run_for(3 * kSecond);
    EXPECT_EQ(outcomes(rig), (std::vector{under_way, no_target}));
    EXPECT_EQ(rig.last_health(kBad)->state, SensorState::ranging);
}

TEST(NodeCalibration, of_a_sensor_that_dies_ends_and_says_why) {
    NodeRig rig(fleet_config(4, 2), setups_with(grey_target(0.140, 8.0)));
    rig.run_for(1 * kSecond);
    command(rig, CommandCode::calibrate_offset, kBad, 140, 1);
    rig.run_for(1 * kSecond);
    EXPECT_EQ(rig.last_health(kBad)->state, SensorState::stopped) << "in mid-calibration";
    EXPECT_EQ(rig.said_of<wire::Heartbeat>().back().degraded_sensors, 0);
    rig.sensor(kBad).set_faults({.is_absent = true});
    rig.run_for(1 * kSecond);
    EXPECT_EQ(outcomes(rig), (std::vector{under_way, device_failed}));
    EXPECT_EQ(rig.last_health(kBad)->state, SensorState::lost);
    command(rig, CommandCode::calibrate_offset, kBad, 140, 2);
    rig.run_for(1 * kSecond);
    EXPECT_EQ(outcomes(rig).back(), not_brought_up);
    rig.sensor(kBad).set_faults({.never_ready = true});
    rig.run_for(10 * kSecond);
    rig.sensor(kBad).set_faults({});
    rig.run_for(15 * kSecond);
    EXPECT_EQ(rig.last_health(kBad)->state, SensorState::ranging) << "it comes back as ever";
}

TEST(NodeCalibration, gives_up_a_sensor_that_gives_no_ranges) {
    NodeRig rig(fleet_config(4, 2), setups_with(grey_target(0.140, 8.0)));
    rig.run_for(1 * kSecond);
    command(rig, CommandCode::calibrate_offset, kBad, 140);
    rig.run_for(1 * kSecond);
    rig.sensor(kBad).set_faults({.never_ready = true});
    rig.run_for(3 * kSecond);
    EXPECT_EQ(outcomes(rig), (std::vector{under_way, no_result}));
}

// Whoever holds the line, the calibration ends, the node lives, and later nothing begins by itself.
TEST(NodeCalibration, ends_when_its_bus_is_held_and_is_possible_again_afterwards) {
    NodeRig rig(fleet_config(4, 2), setups_with(grey_target(0.170, 8.0)));
    rig.run_for(1 * kSecond);
    command(rig, CommandCode::calibrate_offset, kBad, 140, 1);
    rig.run_for(kSecond / 2);
    ASSERT_EQ(outcomes(rig), (std::vector{under_way}));
    // Each attempt to free it, one a second, takes nine of these clocks.
    rig.bus(1).inject({.kind = sim::I2cFaultKind::sda_stuck_low,
                       .first = rig.bus(1).transfer_count() + 1,
                       .position = 150});
    rig.run_for(2 * kSecond);
    ASSERT_TRUE(rig.bus(1).is_held());
    EXPECT_EQ(outcomes(rig), (std::vector{under_way, device_failed}));
    command(rig, CommandCode::calibrate_offset, kBad, 140, 2);
    rig.run_for(2 * kSecond);
    EXPECT_EQ(outcomes(rig), (std::vector{under_way, device_failed, under_way, device_failed}));
    for (int s = 0; s < 60 && rig.bus(1).is_held(); ++s) rig.run_for(1 * kSecond);
    ASSERT_FALSE(rig.bus(1).is_held());
    rig.run_for(15 * kSecond);
    EXPECT_EQ(outcomes(rig).size(), 4U) << "nobody holds the target any more";
    EXPECT_EQ(rig.last_health(kBad)->state, SensorState::ranging);
    command(rig, CommandCode::calibrate_offset, kBad, 140, 3);
    rig.run_for(4 * kSecond);
    EXPECT_EQ(outcomes(rig).back(), done);
}

// Orders in mid-calibration: a stopped sensor stays stopped, and nothing is begun twice.
TEST(NodeCalibration, ends_before_other_orders_are_obeyed) {
    NodeRig rig(fleet_config(4, 2), setups_with(grey_target(0.170, 8.0)));
    rig.run_for(1 * kSecond);
    command(rig, CommandCode::calibrate_offset, kBad, 140, 1);
    rig.run_for(1 * kSecond);
    command(rig, CommandCode::reinitialise_sensor, kBad, 0, 2);
    command(rig, CommandCode::stop, kBad, 0, 3);
    rig.run_for(3 * kSecond);
    EXPECT_EQ(outcomes(rig), (std::vector{under_way, done}));
    EXPECT_EQ(rig.last_health(kBad)->state, SensorState::stopped);
    const std::size_t readings = rig.readings_of(kBad).size();
    rig.run_for(1 * kSecond);
    EXPECT_EQ(rig.readings_of(kBad).size(), readings);
    command(rig, CommandCode::calibrate_offset, kBad, 140, 4);
    rig.run_for(4 * kSecond);
    EXPECT_EQ(outcomes(rig), (std::vector{under_way, done, under_way, done})) << "a stopped one too";
    EXPECT_EQ(rig.said_of<Calibration>().back().offset_quarter_mm, -68);
    EXPECT_EQ(rig.last_health(kBad)->state, SensorState::stopped);
}

TEST(NodeCalibration, tells_its_end_three_times_since_nobody_can_ask_for_it) {
    NodeRig rig(fleet_config(4, 2), setups_with(grey_target(0.170, 8.0)));
    rig.run_for(1 * kSecond);
    command(rig, CommandCode::calibrate_offset, kBad, 140);
    rig.run_for(6 * kSecond);
    const auto said = rig.said_of<Calibration>();
    ASSERT_EQ(said.size(), 1U + 3U);
    EXPECT_EQ(said[1], said[2]);
    EXPECT_EQ(said[1], said[3]);
    const auto times = rig.times_of<Calibration>();
    for (const std::size_t i : {2U, 3U}) EXPECT_LE(times[i].us - times[i - 1].us, 110'000);
}

TEST(NodeCalibration, answers_again_whoever_asks_again_and_begins_no_second_time) {
    NodeRig rig(fleet_config(4, 2), setups_with(grey_target(0.170, 8.0)));
    rig.run_for(1 * kSecond);
    for (int i = 0; i < 2; ++i) {
        command(rig, CommandCode::calibrate_offset, kBad, 140);
        rig.run_for(kSecond * 7 / 10);
    }
    rig.run_for(4 * kSecond);
    const auto said = rig.said_of<Calibration>();
    ASSERT_EQ(said.size(), 2U + 3U);
    EXPECT_EQ(said[1].outcome, under_way) << "not refused";
    EXPECT_EQ(outcomes(rig), (std::vector{under_way, done}));
    EXPECT_EQ(rig.node().counts().rx_rejected, 0U);
}

TEST(NodeCalibration, no_answer_takes_the_place_of_one_that_was_not_sent_yet) {
    NodeRig rig(fleet_config(4, 2), setups_with(grey_target(0.170, 8.0)));
    rig.run_for(1 * kSecond);
    rig.block_transmission(true);
    command(rig, CommandCode::calibrate_offset, kBad, 140, 1);
    rig.run_for(kSecond / 100);
    command(rig, CommandCode::calibrate_offset, 0, 140, 2);
    rig.run_for(kSecond / 100);
    command(rig, CommandCode::calibrate_crosstalk, 9, 140, 3);
    rig.run_for(5 * kSecond);
    rig.block_transmission(false);
    rig.run_for(1 * kSecond);
    EXPECT_EQ(outcomes(rig), (std::vector{under_way, refused, refused, done}));
    std::vector<int> sequences;
    for (const Calibration& said : answers(rig)) sequences.push_back(said.sequence);
    EXPECT_EQ(sequences, (std::vector{1, 2, 3, 1}));
}

// 50 falls of the line a run, and nobody asks because of them.
TEST(NodeCalibration, does_not_make_its_buss_data_ready_line_look_broken) {
    NodeConfig config = fleet_config(4, 4);
    config.data_ready_buses = 0xF;
    NodeRig rig(config, setups_with(grey_target(0.170, 8.0)));
    rig.run_for(1 * kSecond);
    const std::uint32_t spurious = rig.node().counts().spurious_hints;
    for (std::uint8_t i = 0; i < 4; ++i) {
        command(rig, CommandCode::calibrate_offset, kBad, 140, i);
        rig.run_for(4 * kSecond);
        EXPECT_EQ(outcomes(rig).back(), done);
    }
    EXPECT_EQ(rig.node().ignored_data_ready(), 0);
    EXPECT_LE(rig.node().counts().spurious_hints, spurious + 4 * 3) << "not 50 each";
}

// A slow part: longer between two ranges than the two seconds after which a quick one is given up. Its
// neighbours are as slow: four minutes of quick ones would say nothing about it.
TEST(NodeCalibration, of_a_part_with_a_period_of_four_seconds_finds_its_offset) {
    NodeConfig config = fleet_config(4, 2);
    for (SensorConfig& sensor : config.sensors) sensor.inter_measurement_ms = 4'000;
    NodeRig rig(config, setups_with(grey_target(0.170, 8.0)));
    rig.run_for(1 * kSecond);
    command(rig, CommandCode::calibrate_offset, kBad, 140);
    rig.run_for(240 * kSecond);
    ASSERT_EQ(outcomes(rig), (std::vector{under_way, done}));
    EXPECT_EQ(answers(rig)[1].offset_quarter_mm, -68);
}

}  // namespace
}  // namespace octoskin::node::calibrations
