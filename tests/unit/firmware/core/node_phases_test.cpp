// Sensors that are held in their phases: `holds_phases`. Whole minutes and fleets: tests/sim/phases_test.
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "tests/support/node_rig.hpp"
#include "tests/support/turns.hpp"

namespace octoskin::node {
namespace {

constexpr std::uint8_t kSensors = 6;
constexpr Microseconds kSecond{1'000'000};
constexpr double kPeriodUs = 33'000.0;

/// Three sensors on each of two buses, a third of a period apart.
NodeConfig held_fleet() {
    NodeConfig config = test::fleet_config(kSensors, 2);
    config.holds_phases = true;
    for (std::uint8_t i = 0; i < kSensors; ++i)
        config.sensors.at(i).phase_us = static_cast<std::uint16_t>(5'500 * i);
    return config;
}

/// Oscillators off by up to 6 %, ranges that begin up to 4 ms before their windows.
std::vector<test::SensorSetup> parts() {
    std::vector<test::SensorSetup> setups(kSensors);
    for (std::uint8_t i = 0; i < kSensors; ++i) {
        setups[i].part.slow_clock_factor = 1.015 + 0.024 * i;
        setups[i].part.range_overhead = Microseconds{800 * i};
    }
    return setups;
}

class NodePhasesTest : public testing::Test {
  protected:
    /// How far any sensor was out of its phase at most between these times, us.
    [[nodiscard]] double worst_off_us(Microseconds from, Microseconds until) const {
        std::vector<std::vector<double>> middles_us(kSensors);
        std::vector<double> phases_us;
        for (std::uint8_t i = 0; i < kSensors; ++i) {
            for (const test::TrueRange& range : rig_.truth(i)) {
                const auto middle = static_cast<double>(rig_.clock().to_node(range.window_middle).us);
                if (range.window_middle.us >= from.count() && range.window_middle.us < until.count())
                    middles_us[i].push_back(middle);
            }
            phases_us.push_back(rig_.config().sensors.at(i).phase_us);
        }
        return test::worst_off_us(middles_us, phases_us, kPeriodUs);
    }
    [[nodiscard]] std::size_t readings_in(std::uint8_t sensor, Microseconds duration) {
        const std::size_t before = rig_.readings_of(sensor).size();
        rig_.run_for(duration);
        return rig_.readings_of(sensor).size() - before;
    }

    test::NodeRig rig_{held_fleet(), parts()};
};

TEST_F(NodePhasesTest, holds_every_sensor_within_half_a_millisecond_and_gives_up_few_ranges) {
    rig_.run_for(5 * kSecond);
    const std::size_t taken = readings_in(0, 6 * kSecond);
    EXPECT_LE(worst_off_us(5 * kSecond, 11 * kSecond), 500.0);
    EXPECT_GE(static_cast<double>(taken), 0.95 * 6e6 / kPeriodUs);
}

// The last result of a run is looked for and read like any other: also if it cannot be read.
TEST_F(NodePhasesTest, comes_back_into_phase_after_reads_that_were_altered) {
    rig_.run_for(4 * kSecond);
    for (int i = 0; i < 100; ++i) {
        for (std::size_t bus = 0; bus < 2; ++bus) {
            rig_.bus(bus).inject({.kind = sim::I2cFaultKind::flip_bit,
                                  .first = rig_.bus(bus).transfer_count() + static_cast<std::uint64_t>(i) % 7,
                                  .position = static_cast<std::uint32_t>(13 * i) % 136});
        }
        rig_.run_for(Microseconds{30'000});
    }
    rig_.run_for(3 * kSecond);
    for (std::uint8_t i = 0; i < kSensors; ++i)
        EXPECT_EQ(rig_.last_health(i)->state, wire::SensorState::ranging) << int{i};
    rig_.run_for(3 * kSecond);
    EXPECT_LE(worst_off_us(10 * kSecond, 13 * kSecond), 500.0);
}

TEST_F(NodePhasesTest, stops_at_once_whatever_it_waits_for) {
    rig_.run_for(4 * kSecond);
    std::uint8_t sequence = 0;
    const auto order = [&](wire::CommandCode code) {
        rig_.send_from_host(wire::Command{.code = code, .sensor = wire::kAllSensors, .sequence = ++sequence},
                            rig_.config().node_id);
    };
    for (int i = 0; i < 30; ++i) {
        rig_.run_for(Microseconds{100'000 + 1'700 * i});
        order(wire::CommandCode::stop);
        rig_.run_for(Microseconds{150'000});
        for (std::uint8_t sensor = 0; sensor < kSensors; ++sensor)
            EXPECT_EQ(rig_.last_health(sensor)->state, wire::SensorState::stopped) << i;
        order(wire::CommandCode::start);
    }
    EXPECT_GE(readings_in(0, kSecond), 25U);
}

}  // namespace
}  // namespace octoskin::node
