// What a sensor or a bus that fails costs, and how it comes back.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "common/range_status.hpp"
#include "tests/support/node_rig.hpp"

namespace octoskin::node {
namespace {

using test::fleet_config;
using test::NodeRig;
using test::SaidReading;
using test::SensorSetup;
using wire::SensorFault;
using wire::SensorState;

constexpr Microseconds kSecond{1'000'000};

class NodeRecoveryTest : public testing::Test {
  protected:
    NodeRecoveryTest() : rig_(fleet_config(6, 2), std::vector<SensorSetup>(6)) { rig_.run_for(2 * kSecond); }

    std::size_t readings_after(std::uint8_t sensor, std::int64_t us) {
        const auto readings = rig_.readings_of(sensor);
        return static_cast<std::size_t>(std::count_if(
            readings.begin(), readings.end(), [=](const SaidReading& said) { return said.end.us >= us; }));
    }
    /// The longest time without a reading of `sensor` from `us` on.
    std::int64_t longest_gap_us(std::uint8_t sensor, std::int64_t us) {
        std::int64_t longest = 0;
        std::int64_t last = us;
        for (const SaidReading& said : rig_.readings_of(sensor)) {
            if (said.end.us < us) continue;
            longest = std::max(longest, said.end.us - last);
            last = said.end.us;
        }
        return std::max(longest, rig_.now().us - last);
    }
    void expect_neighbours_undisturbed(std::int64_t since_us) {
        for (std::uint8_t sensor = 0; sensor < 6; ++sensor) {
            if (sensor == 2) continue;
            EXPECT_EQ(rig_.last_health(sensor)->state, SensorState::ranging) << int{sensor};
            EXPECT_LE(longest_gap_us(sensor, since_us), 2 * 33'000 + 5'000) << int{sensor};
        }
    }
    NodeRig rig_;
};

// Device codes 1, 2, 3 and 17: VCSEL continuity, VCSEL watchdog, no VHV value, multiple clips. High bits at
// random.
TEST_F(NodeRecoveryTest,
       a_sensor_that_calls_range_after_range_a_hardware_failure_is_named_and_brought_up_anew) {
    for (const std::uint8_t status : std::array<std::uint8_t, 4>{0x01, 0x42, 0xA3, 0x31}) {
        const std::int64_t broken_us = rig_.now().us;
        const std::uint32_t restarts = rig_.node().counts().sensor_restarts;
        rig_.sensor(2).set_faults({.device_status = status});
        rig_.run_for(1 * kSecond);
        EXPECT_EQ(rig_.last_health(2)->state, SensorState::degraded) << int{status};
        EXPECT_EQ(rig_.last_health(2)->fault, SensorFault::hardware_fail) << int{status};
        EXPECT_EQ(rig_.said_of<wire::Heartbeat>().back().degraded_sensors, 1);
        rig_.run_for(9 * kSecond);
        EXPECT_EQ(rig_.last_health(2)->state, SensorState::degraded) << "through every attempt";
        const std::uint32_t attempts = rig_.node().counts().sensor_restarts - restarts;
        EXPECT_GE(attempts, 4U);
        EXPECT_LE(attempts, 9U) << "never hurried";
        for (const SaidReading& said : rig_.readings_of(2)) {
            if (said.end.us < broken_us + 40'000) continue;
            EXPECT_EQ(said.reading.device_status, status & 0x1F) << "told as it is";
        }
        expect_neighbours_undisturbed(broken_us);
        rig_.sensor(2).set_faults({});
        rig_.run_for(15 * kSecond);
        EXPECT_EQ(rig_.last_health(2)->state, SensorState::ranging) << int{status};
        EXPECT_EQ(rig_.said_of<wire::Heartbeat>().back().degraded_sensors, 0);
    }
}

TEST_F(NodeRecoveryTest, a_hardware_failure_now_and_then_costs_nothing) {
    const std::uint32_t restarts = rig_.node().counts().sensor_restarts;
    for (int i = 0; i < 20; ++i) {
        rig_.sensor(2).set_faults({.device_status = std::uint8_t{3}});
        rig_.run_for(8 * Microseconds{33'000});
        rig_.sensor(2).set_faults({});
        rig_.run_for(3 * Microseconds{33'000});
    }
    EXPECT_EQ(rig_.node().counts().sensor_restarts, restarts);
    EXPECT_EQ(rig_.last_health(2)->state, SensorState::ranging);
}

// What the scene does to a sensor is no failure of it: no target for hours, too bright, too noisy.
TEST_F(NodeRecoveryTest, no_other_status_ends_a_sensors_ranging) {
    const std::uint32_t restarts = rig_.node().counts().sensor_restarts;
    // Those that do not exist are bus errors read as data.
    for (std::uint8_t status = 0; status < kDeviceStatusesDefined; ++status) {
        if (status == 1 || status == 2 || status == 3 || status == 17) continue;
        rig_.sensor(2).set_faults({.device_status = status});
        rig_.run_for(20 * Microseconds{33'000});
        EXPECT_EQ(rig_.last_health(2)->state, SensorState::ranging) << int{status};
    }
    EXPECT_EQ(rig_.node().counts().sensor_restarts, restarts);
}

TEST_F(NodeRecoveryTest, names_a_frozen_sensor_within_a_second_and_never_repeats_its_last_value) {
    const std::int64_t frozen_us = rig_.now().us;
    rig_.sensor(2).set_faults({.freezes_stream = true});
    rig_.run_for(1 * kSecond);
    EXPECT_EQ(rig_.last_health(2)->state, SensorState::degraded);
    EXPECT_EQ(rig_.last_health(2)->fault, SensorFault::stale_stream);
    EXPECT_GE(rig_.last_health(2)->rejected, 5);
    EXPECT_LE(rig_.last_health(2)->rejected, rig_.node().counts().rejected);
    for (const auto& item : rig_.said()) {
        const auto* health = std::get_if<wire::SensorHealth>(&item.message);
        if (health != nullptr && health->sensor == 2 && item.end.us > frozen_us) {
            EXPECT_NE(health->fault, SensorFault::no_data_ready) << "it gives data, though always the same";
        }
    }
    EXPECT_EQ(rig_.said_of<wire::Heartbeat>().back().degraded_sensors, 1);
    rig_.run_for(4 * kSecond);
    // All it may send is the first result after each restart, marked as such.
    for (const SaidReading& said : rig_.readings_of(2)) {
        if (said.end.us > frozen_us + 60'000) {
            EXPECT_EQ(said.reading.device_status, 19);
        }
    }
    expect_neighbours_undisturbed(frozen_us);
}

TEST_F(NodeRecoveryTest, names_a_sensor_that_is_never_ready_and_takes_it_back_when_it_is) {
    const std::int64_t failed_us = rig_.now().us;
    rig_.sensor(2).set_faults({.never_ready = true});
    rig_.run_for(1 * kSecond);
    EXPECT_EQ(rig_.last_health(2)->state, SensorState::degraded);
    EXPECT_EQ(rig_.last_health(2)->fault, SensorFault::no_data_ready);
    rig_.sensor(2).set_faults({});
    rig_.run_for(4 * kSecond);
    EXPECT_EQ(rig_.last_health(2)->state, SensorState::ranging);
    EXPECT_GE(readings_after(2, rig_.now().us - 1'000'000), 28U);
    expect_neighbours_undisturbed(failed_us);
}

TEST_F(NodeRecoveryTest, brings_a_sensor_back_after_a_brown_out_within_half_a_second) {
    const std::int64_t failed_us = rig_.now().us;
    rig_.sensor(2).brown_out(rig_.now());
    rig_.run_for(2 * kSecond);
    // 3 periods to notice, 300 ms to re-initialise, 2 periods to range
    EXPECT_LE(longest_gap_us(2, failed_us), 3 * 33'000 + 300'000 + 2 * 33'000);
    EXPECT_EQ(rig_.last_health(2)->state, SensorState::ranging);
    EXPECT_EQ(rig_.last_health(2)->fault, SensorFault::no_answer);
    EXPECT_GE(rig_.node().counts().sensor_restarts, 1U);
    expect_neighbours_undisturbed(failed_us);
}

TEST_F(NodeRecoveryTest, brings_a_sensor_back_as_fast_after_its_sixth_brown_out) {
    for (int i = 0; i < 6; ++i) {
        const std::int64_t failed_us = rig_.now().us;
        rig_.sensor(2).brown_out(rig_.now());
        rig_.run_for(2 * kSecond);
        EXPECT_LE(longest_gap_us(2, failed_us), 3 * 33'000 + 300'000 + 2 * 33'000) << i;
    }
}

TEST_F(NodeRecoveryTest, holds_a_failed_sensor_in_reset_while_it_waits_ever_longer) {
    rig_.sensor(2).set_faults({.freezes_stream = true});
    const std::size_t before = rig_.xshut_events().size();
    rig_.run_for(5 * kSecond);
    std::vector<std::int64_t> lows_us;
    std::optional<std::int64_t> low_since_us;
    for (std::size_t i = before; i < rig_.xshut_events().size(); ++i) {
        const auto& event = rig_.xshut_events()[i];
        ASSERT_EQ(event.line, 2);
        if (event.is_high) {
            lows_us.push_back(event.time.us - low_since_us.value());
            low_since_us.reset();
        } else if (!low_since_us) {
            low_since_us = event.time.us;
        }
    }
    ASSERT_GE(lows_us.size(), 5U);
    const std::vector<std::int64_t> waits_us = {0, 100'000, 200'000, 400'000, 800'000};
    for (std::size_t i = 0; i < waits_us.size(); ++i) {
        EXPECT_GE(lows_us[i], waits_us[i] + 1'000);
        EXPECT_LE(lows_us[i], waits_us[i] + 5'000);
    }
}

TEST_F(NodeRecoveryTest, brings_all_sensors_back_after_they_browned_out_together) {
    for (std::size_t sensor = 0; sensor < 6; ++sensor) rig_.sensor(sensor).brown_out(rig_.now());
    rig_.run_for(2 * kSecond);
    for (std::uint8_t sensor = 0; sensor < 6; ++sensor) {
        EXPECT_EQ(rig_.last_health(sensor)->state, SensorState::ranging) << int{sensor};
        EXPECT_GE(readings_after(sensor, rig_.now().us - 500'000), 14U) << int{sensor};
    }
}

TEST_F(NodeRecoveryTest, tries_an_absent_sensor_ever_more_rarely) {
    std::vector<SensorSetup> setups(2);
    setups[1].is_fitted = false;
    NodeRig rig(fleet_config(2, 1), setups);
    rig.run_for(30 * kSecond);
    const auto events = rig.xshut_events();
    const auto rises = std::count_if(events.begin(), events.end(),
                                     [](const auto& event) { return event.line == 1 && event.is_high; });
    // At 0, then 0, 0.1, 0.2, ... 6.4 and 10 s after each failure.
    EXPECT_EQ(rises, 10);
}

TEST_F(NodeRecoveryTest, does_not_lose_a_reading_to_a_single_refused_address) {
    const std::int64_t failed_us = rig_.now().us;
    rig_.bus(0).inject({.kind = sim::I2cFaultKind::nack_address, .first = rig_.bus(0).transfer_count() + 7});
    rig_.run_for(1 * kSecond);
    EXPECT_EQ(rig_.node().counts().i2c_errors, 1U);
    for (std::uint8_t sensor = 0; sensor < 6; ++sensor) {
        EXPECT_LE(longest_gap_us(sensor, failed_us), 40'000) << int{sensor};
    }
}

TEST_F(NodeRecoveryTest, never_sends_a_range_with_a_bit_flipped_in_one_of_its_two_reads) {
    // Every bit of a result three times over; some hit polls and read-backs instead.
    for (std::uint32_t i = 0; i < 3 * 136; ++i) {
        rig_.bus(0).inject({.kind = sim::I2cFaultKind::flip_bit,
                            .first = rig_.bus(0).transfer_count() + 50 + 29 * i,
                            .position = i % 136});
    }
    rig_.run_for(20 * kSecond);
    for (std::uint8_t sensor = 0; sensor < 6; ++sensor) {
        std::size_t truth = 0;
        for (const SaidReading& said : rig_.readings_of(sensor)) {
            // Every distance sent was truly measured, in this order.
            while (truth < rig_.truth(sensor).size() &&
                   rig_.truth(sensor)[truth].range_mm != said.reading.range_mm) {
                ++truth;
            }
            ASSERT_LT(truth, rig_.truth(sensor).size()) << int{sensor};
        }
    }
    // Now and then a refused result makes no degraded sensor.
    EXPECT_GT(rig_.node().counts().reads_disagreed, 3 * 10U);
    for (const wire::SensorHealth& health : rig_.said_of<wire::SensorHealth>()) {
        EXPECT_NE(health.state, SensorState::degraded);
    }
}

TEST_F(NodeRecoveryTest, survives_a_clock_stretched_without_end) {
    const std::int64_t failed_us = rig_.now().us;
    rig_.bus(0).inject(
        {.kind = sim::I2cFaultKind::stretch, .first = rig_.bus(0).transfer_count() + 3, .count = 2});
    rig_.run_for(2 * kSecond);
    for (std::uint8_t sensor = 0; sensor < 6; ++sensor) {
        EXPECT_EQ(rig_.last_health(sensor)->state, SensorState::ranging) << int{sensor};
        EXPECT_LE(longest_gap_us(sensor, failed_us), 465'000) << int{sensor};
    }
}

TEST_F(NodeRecoveryTest, frees_a_bus_that_is_held_until_nine_clocks_are_given) {
    rig_.bus(0).inject({.kind = sim::I2cFaultKind::sda_stuck_low,
                        .first = rig_.bus(0).transfer_count() + 3,
                        .count = 1'000'000,
                        .position = 9});
    rig_.run_for(2 * kSecond);
    for (std::uint8_t sensor = 0; sensor < 6; ++sensor) {
        EXPECT_EQ(rig_.last_health(sensor)->state, SensorState::ranging) << int{sensor};
    }
}

TEST_F(NodeRecoveryTest, frees_a_bus_from_a_sensor_that_only_a_reset_makes_let_go) {
    rig_.sensor(2).set_faults({.holds_sda_clocks = 1'000'000});
    rig_.run_for(2 * kSecond);
    for (std::uint8_t sensor = 0; sensor < 6; ++sensor) {
        EXPECT_EQ(rig_.last_health(sensor)->state, SensorState::ranging) << int{sensor};
        EXPECT_GE(readings_after(sensor, rig_.now().us - 500'000), 14U) << int{sensor};
    }
}

TEST_F(NodeRecoveryTest, tries_once_a_second_to_free_a_bus_that_stays_held) {
    // Two attempts at once, then one a second: the clocks of each are nine.
    rig_.bus(0).inject(
        {.kind = sim::I2cFaultKind::sda_stuck_low, .first = rig_.bus(0).transfer_count(), .position = 100});
    rig_.run_for(2 * kSecond);
    for (const std::uint8_t sensor : std::array<std::uint8_t, 3>{0, 2, 4}) {
        EXPECT_EQ(rig_.last_health(sensor)->state, SensorState::lost) << int{sensor};
        EXPECT_EQ(rig_.last_health(sensor)->fault, SensorFault::bus_error) << int{sensor};
    }
    EXPECT_EQ(rig_.said_of<wire::Heartbeat>().back().degraded_sensors, 3);
    EXPECT_EQ(rig_.node().state(), wire::NodeState::ranging) << "the other bus is well";
    rig_.run_for(15 * kSecond);
    for (std::uint8_t sensor = 0; sensor < 6; ++sensor) {
        EXPECT_EQ(rig_.last_health(sensor)->state, SensorState::ranging) << int{sensor};
    }
}

TEST_F(NodeRecoveryTest, reports_its_buses_faulty_when_none_can_be_freed_and_keeps_its_heartbeat) {
    const std::size_t heartbeats = rig_.said_of<wire::Heartbeat>().size();
    for (const std::size_t bus : {0U, 1U}) {
        rig_.bus(bus).inject({.kind = sim::I2cFaultKind::sda_stuck_low,
                              .first = rig_.bus(bus).transfer_count(),
                              .count = 1'000'000'000,
                              .position = 1'000'000});
    }
    rig_.run_for(3 * kSecond);
    EXPECT_EQ(rig_.node().state(), wire::NodeState::bus_fault);
    EXPECT_EQ(rig_.said_of<wire::Heartbeat>().size(), heartbeats + 30);
    EXPECT_EQ(rig_.said_of<wire::Heartbeat>().back().state, wire::NodeState::bus_fault);
}

}  // namespace
}  // namespace octoskin::node
