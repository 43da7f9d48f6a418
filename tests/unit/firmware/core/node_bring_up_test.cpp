// Bring-up of whole fleets: the real driver against modelled sensors and buses.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>

#include "tests/support/node_rig.hpp"

namespace octoskin::node {
namespace {

using test::fleet_config;
using test::NodeRig;
using test::SensorSetup;
using test::XshutEvent;
using wire::SensorFault;
using wire::SensorState;

constexpr Microseconds kMillisecond{1'000};

std::vector<SensorSetup> fleet(std::size_t count) {
    return std::vector<SensorSetup>(count);
}

/// XSHUT rises in the order of time, by bus.
std::map<int, std::vector<XshutEvent>> rises_by_bus(const NodeRig& rig, const NodeConfig& config) {
    std::map<int, std::vector<XshutEvent>> rises;
    for (const XshutEvent& event : rig.xshut_events()) {
        if (event.is_high) rises[config.sensors.at(event.line).bus].push_back(event);
    }
    return rises;
}

TEST(NodeBringUp, has_17_sensors_on_4_buses_ranging_within_a_third_of_a_second) {
    NodeRig rig(fleet_config(17, 4), fleet(17));
    rig.run_for(333 * kMillisecond);
    EXPECT_EQ(rig.node().state(), wire::NodeState::ranging);
    for (std::uint8_t sensor = 0; sensor < 17; ++sensor) {
        ASSERT_TRUE(rig.last_health(sensor).has_value());
        EXPECT_EQ(rig.last_health(sensor)->state, SensorState::ranging) << int{sensor};
        EXPECT_GE(rig.readings_of(sensor).size(), 1U) << int{sensor};
    }
    EXPECT_EQ(rig.node().counts().i2c_errors, 0U);
}

TEST(NodeBringUp, starts_each_sensor_in_the_same_period_however_long_all_of_it_took) {
    NodeConfig config = fleet_config(17, 4);
    for (std::uint8_t i = 0; i < 17; ++i)
        config.sensors.at(i).phase_us = static_cast<std::uint16_t>(1'500 * i);
    // 250 ms on, the last phase of a period is over and the next one's first is 8 ms away: time for all to be
    // given their period.
    const sim::NodeClock clock(NodeTime{33'000 * 100 + 25'000 - 250'000}, 0.0);
    NodeRig fast(config, fleet(17), clock);
    config.i2c_hz = 300'000;
    NodeRig slow(config, fleet(17), clock);
    for (NodeRig* rig : {&fast, &slow}) rig->run_for(400 * kMillisecond);
    for (std::size_t sensor = 0; sensor < 17; ++sensor) {
        // The first one belongs to the bring-up.
        const std::int64_t fast_us = fast.truth(sensor).at(1).window_middle.us;
        const std::int64_t slow_us = slow.truth(sensor).at(1).window_middle.us;
        EXPECT_GE(fast_us, 258'000) << sensor;
        EXPECT_NEAR(static_cast<double>(fast_us), static_cast<double>(slow_us), 300.0) << sensor;
    }
}

TEST(NodeBringUp, holds_every_sensor_in_reset_for_a_millisecond_before_the_first_rises) {
    NodeRig rig(fleet_config(17, 4), fleet(17));
    rig.run_for(333 * kMillisecond);
    std::array<bool, 17> was_low{};
    for (const XshutEvent& event : rig.xshut_events()) {
        if (!event.is_high) {
            EXPECT_EQ(event.time.us, 0);
            was_low.at(event.line) = true;
        } else {
            EXPECT_GE(event.time.us, 1'000);
        }
    }
    EXPECT_TRUE(std::all_of(was_low.begin(), was_low.end(), [](bool low) { return low; }));
}

TEST(NodeBringUp, raises_one_sensor_of_a_bus_at_a_time_and_all_buses_side_by_side) {
    const NodeConfig config = fleet_config(17, 4);
    NodeRig rig(config, fleet(17));
    rig.run_for(333 * kMillisecond);
    const auto rises = rises_by_bus(rig, config);
    ASSERT_EQ(rises.size(), 4U);
    for (const auto& [bus, events] : rises) {
        ASSERT_EQ(events.size(), bus == 0 ? 5U : 4U);
        EXPECT_LE(events.front().time.us, 1'500);
        for (std::size_t i = 1; i < events.size(); ++i) {
            EXPECT_GT(events[i].line, events[i - 1].line);
            // 2 ms to boot; then identification (57 bits), new address (38), its read-back (57) and twice
            // nobody at 0x29 (11 each) at 400 kHz
            EXPECT_GE(events[i].time.us - events[i - 1].time.us, 2'000 + 435);
        }
    }
}

TEST(NodeBringUp, starts_each_sensor_in_its_phase) {
    NodeConfig config = fleet_config(5, 1);
    const std::array<std::uint16_t, 5> phases_us = {0, 6'000, 12'000, 18'000, 27'000};
    std::vector<SensorSetup> setups = fleet(5);
    for (std::size_t i = 0; i < 5; ++i) {
        config.sensors[i].phase_us = phases_us[i];
        setups[i].part.slow_clock_factor = 1.075;  // a part that is exactly as the driver assumes
    }
    NodeRig rig(config, setups);
    rig.run_for(400 * kMillisecond);
    for (std::size_t i = 0; i < 5; ++i) {
        // Range 0 is the first one, of initialisation; a window's middle is half a budget before its end, and
        // the first range of a start ends one period after it.
        const std::int64_t start_us = rig.truth(i).at(1).window_middle.us + 10'000 - 33'000;
        const std::int64_t into_phase_us = (start_us - phases_us[i] + 33'000) % 33'000;
        // The bus may be taken by a neighbour's longest transfer: its configuration, 94 bytes, 2.2 ms.
        EXPECT_LE(into_phase_us, 3'000) << i;
    }
}

TEST(NodeBringUp, names_an_absent_sensor_and_a_stranger_and_goes_on_with_the_others) {
    std::vector<SensorSetup> setups = fleet(17);
    setups[3].is_fitted = false;
    setups[8].faults.has_wrong_id = true;
    NodeRig rig(fleet_config(17, 4), setups);
    rig.run_for(1'000 * kMillisecond);

    EXPECT_EQ(rig.node().state(), wire::NodeState::ranging);
    EXPECT_EQ(rig.said_of<wire::Heartbeat>().back().degraded_sensors, 2);
    EXPECT_EQ(rig.last_health(3)->state, SensorState::absent);
    EXPECT_EQ(rig.last_health(3)->fault, SensorFault::no_answer);
    EXPECT_EQ(rig.last_health(8)->state, SensorState::degraded);
    EXPECT_EQ(rig.last_health(8)->fault, SensorFault::wrong_id);
    for (std::uint8_t sensor = 0; sensor < 17; ++sensor) {
        if (sensor == 3 || sensor == 8) {
            EXPECT_TRUE(rig.readings_of(sensor).empty());
            continue;
        }
        EXPECT_EQ(rig.last_health(sensor)->state, SensorState::ranging) << int{sensor};
        EXPECT_LT(rig.readings_of(sensor).front().end.us, 350'000) << int{sensor};
    }
}

TEST(NodeBringUp, leaves_a_failed_sensor_in_reset_so_that_it_is_not_taken_for_its_neighbour) {
    std::vector<SensorSetup> setups = fleet(2);
    setups[0].faults.has_wrong_id = true;
    const NodeConfig config = fleet_config(2, 1);
    NodeRig rig(config, setups);
    bool is_stranger_high = false;
    rig.run_for(400 * kMillisecond);
    for (const XshutEvent& event : rig.xshut_events()) {
        if (event.line == 0) is_stranger_high = event.is_high;
        if (event.line == 1 && event.is_high) {
            EXPECT_FALSE(is_stranger_high);
        }
    }
    EXPECT_EQ(rig.last_health(1)->state, SensorState::ranging);
}

TEST(NodeBringUp, moves_a_stray_sensor_out_of_the_way_and_says_on_which_bus_it_is) {
    NodeRig rig(fleet_config(4, 2), fleet(4));
    rig.attach_stray_sensor(1);
    rig.run_for(2'250 * kMillisecond);
    for (std::uint8_t sensor = 0; sensor < 4; ++sensor) {
        EXPECT_EQ(rig.last_health(sensor)->state, SensorState::ranging) << int{sensor};
        EXPECT_EQ(rig.last_health(sensor)->fault, SensorFault::none) << int{sensor};
        EXPECT_GE(rig.readings_of(sensor).size(), 50U) << int{sensor};
    }
    wire::InfoFault reported;
    for (const wire::NodeInfo& info : rig.said_of<wire::NodeInfo>()) {
        if (const auto* fault = std::get_if<wire::InfoFault>(&info)) reported = *fault;
    }
    EXPECT_EQ(reported, (wire::InfoFault{.kind = wire::FaultKind::stray_sensor, .where = 1}));
}

TEST(NodeBringUp, refuses_a_bus_where_a_stranger_answers_at_0x29) {
    NodeRig rig(fleet_config(2, 1), fleet(2));
    rig.attach_stray_sensor(0, {.has_wrong_id = true});
    rig.run_for(1'000 * kMillisecond);
    for (std::uint8_t sensor = 0; sensor < 2; ++sensor) {
        EXPECT_EQ(rig.last_health(sensor)->fault, SensorFault::address_conflict);
        EXPECT_TRUE(rig.readings_of(sensor).empty());
    }
}

TEST(NodeBringUp, is_not_begun_again_by_an_order_to_do_what_is_under_way) {
    NodeRig rig(fleet_config(2, 1), fleet(2));
    rig.run_for(5 * kMillisecond);
    rig.send_from_host(wire::Command{.code = wire::CommandCode::reinitialise_sensor}, 5);
    rig.run_for(500 * kMillisecond);
    EXPECT_EQ(rig.xshut_events().size(), 4U);  // each low, then high
    EXPECT_EQ(rig.last_health(1)->state, SensorState::ranging);
}

TEST(NodeBringUp, waits_for_a_part_that_is_slow_to_say_that_it_has_booted) {
    std::vector<SensorSetup> setups = fleet(2);
    setups[1].faults.status_two_for = 40 * kMillisecond;
    NodeRig rig(fleet_config(2, 1), setups);
    rig.run_for(500 * kMillisecond);
    EXPECT_EQ(rig.last_health(0)->state, SensorState::ranging);
    EXPECT_EQ(rig.last_health(1)->state, SensorState::ranging);
}

TEST(NodeBringUp, says_that_a_part_never_boots) {
    std::vector<SensorSetup> setups = fleet(2);
    setups[1].faults.status_two_for = 60'000 * kMillisecond;
    NodeRig rig(fleet_config(2, 1), setups);
    rig.run_for(1'000 * kMillisecond);
    EXPECT_EQ(rig.last_health(0)->state, SensorState::ranging);
    EXPECT_EQ(rig.last_health(1)->state, SensorState::degraded);
    EXPECT_EQ(rig.last_health(1)->fault, SensorFault::boot_timeout);
}

// PAD_I2C_HV__EXTSUP_CONFIG and GPIO_HV_PAD__CTRL: ST's API, "2V8" mode.
TEST(NodeBringUp, sets_the_sensors_pads_to_the_boards_voltage) {
    for (const bool is_io_2v8 : {true, false}) {
        NodeConfig config = fleet_config(1, 1);
        config.is_io_2v8 = is_io_2v8;
        NodeRig rig(config, fleet(1));
        rig.run_for(333 * kMillisecond);
        ASSERT_EQ(rig.last_health(0)->state, SensorState::ranging);
        for (const std::uint16_t pad : std::array<std::uint16_t, 2>{0x002E, 0x002F})
            EXPECT_EQ(rig.sensor(0).registers()[pad], is_io_2v8 ? 0x01 : 0x00) << pad;
    }
}

TEST(NodeBringUp, takes_34_sensors_on_4_buses) {
    NodeRig rig(fleet_config(34, 4), fleet(34));
    rig.run_for(400 * kMillisecond);
    for (std::uint8_t sensor = 0; sensor < 34; ++sensor) {
        EXPECT_GE(rig.readings_of(sensor).size(), 1U) << int{sensor};
    }
}

TEST(NodeBringUp, keeps_still_with_a_configuration_that_no_board_can_have) {
    NodeConfig config = fleet_config(4, 2);
    config.sensors[2].address = 0x29;
    NodeRig rig(config, fleet(4));
    rig.run_for(1'000 * kMillisecond);
    EXPECT_TRUE(rig.xshut_events().empty());
    EXPECT_EQ(rig.said_of<wire::Heartbeat>().size(), 10U);
    EXPECT_EQ(rig.said_of<wire::Heartbeat>().back().state, wire::NodeState::bad_config);
}

TEST(NodeBringUp, says_nothing_at_all_without_a_node_id_of_its_own) {
    for (const int node_id : {0, 63, 64}) {
        NodeConfig config = fleet_config(4, 2);
        config.node_id = static_cast<std::uint8_t>(node_id);
        NodeRig rig(config, fleet(4));
        rig.run_for(1'000 * kMillisecond);
        EXPECT_TRUE(rig.frames().empty());
    }
}

TEST(NodeBringUp, is_in_order_without_any_sensor) {
    NodeRig rig(fleet_config(0, 1), {});
    rig.run_for(1'000 * kMillisecond);
    EXPECT_EQ(rig.node().state(), wire::NodeState::ranging);
    EXPECT_EQ(rig.said_of<wire::Heartbeat>().size(), 10U);
}

TEST(NodeBringUp, does_not_try_what_the_sensor_refuses_for_ever_but_says_bad_config) {
    struct Timing {
        DistanceMode mode;
        std::uint16_t budget_ms;
        std::uint16_t period_ms;
    };
    using enum DistanceMode;
    const auto state_with = [](const Timing& timing) {
        NodeConfig config = fleet_config(2, 1);
        config.sensors[1].distance_mode = timing.mode;
        config.sensors[1].timing_budget_ms = timing.budget_ms;
        config.sensors[1].inter_measurement_ms = timing.period_ms;
        EXPECT_TRUE(is_valid(config)) << "as far as a block can tell";
        NodeRig rig(config, fleet(2));
        rig.run_for(10 * kMillisecond);
        return rig.said_of<wire::Heartbeat>().back().state;
    };
    for (const Timing& refused :
         {Timing{long_range, 16, 33}, Timing{short_range, 1'000, 1'100}, Timing{long_range, 15, 33},
          Timing{medium_range, 20, 33}, Timing{long_range, 33, 33}, Timing{long_range, 33, 37}}) {
        EXPECT_EQ(state_with(refused), wire::NodeState::bad_config) << refused.budget_ms;
    }
    for (const Timing& taken : {Timing{short_range, 15, 33}, Timing{medium_range, 33, 38},
                                Timing{long_range, 20, 25}, Timing{long_range, 500, 505}}) {
        EXPECT_EQ(state_with(taken), wire::NodeState::starting) << taken.budget_ms;
    }
}

}  // namespace
}  // namespace octoskin::node
