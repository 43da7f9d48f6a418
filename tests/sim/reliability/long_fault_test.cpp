// F4: faults that last longer than half the period of the node's clock, when every time kept from before them
// looks like a time to come; and longer than a whole one. With the clock's wrap before, in and after the
// fault.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "tests/sim/reliability/oracles.hpp"

namespace octoskin::test {
namespace {

using wire::NodeState;
using wire::SensorState;

constexpr Microseconds kMinute{60'000'000};
constexpr std::uint8_t kSensors = 4;
constexpr std::int64_t kSlowPeriodUs = 1'000'000;
/// reliability: 300 ms to re-initialise and 2 periods; a faulty bus is looked at once a second.
constexpr std::int64_t kBusBackUs = 1'000'000 + 300'000 + 2 * kSlowPeriodUs;

/// Sensors 0 and 2 on bus 0, 1 and 3 on bus 1, once a second.
NodeConfig slow_config() {
    NodeConfig config = fleet_config(kSensors, 2);
    for (std::uint8_t i = 0; i < kSensors; ++i) {
        config.sensors[i].inter_measurement_ms = 1'000;
        config.sensors[i].phase_us = static_cast<std::uint16_t>(16'000U * i);
    }
    return config;
}

struct Case {
    const char* name;
    int minutes;     ///< that the fault lasts, from the first minute on
    int wrap_after;  ///< minutes after the start
};

class LongFaultTest : public testing::TestWithParam<Case> {
  protected:
    LongFaultTest()
        : rig_(slow_config(), std::vector<SensorSetup>(kSensors),
               sim::NodeClock{{static_cast<std::uint32_t>(-60'000'000LL * GetParam().wrap_after)}, 0.0}) {
        rig_.run_for(kMinute);
    }
    [[nodiscard]] Microseconds duration() const { return GetParam().minutes * kMinute; }
    void expect_all_range() {
        EXPECT_EQ(rig_.said_of<wire::Heartbeat>().back().degraded_sensors, 0);
        EXPECT_EQ(rig_.node().state(), NodeState::ranging);
        expect_readings_accounted_for(rig_.node());
        for (std::uint8_t sensor = 0; sensor < kSensors; ++sensor) {
            EXPECT_EQ(rig_.last_health(sensor)->state, SensorState::ranging) << int{sensor};
            expect_only_the_truth(rig_, sensor);
        }
    }
    NodeRig rig_;
};

TEST_P(LongFaultTest, F4_a_bus_held_for_long_has_all_its_sensors_back_at_once) {
    // Each look at a faulty bus, one a second, gives it nine clocks.
    const auto clocks = static_cast<std::uint32_t>(9 * 60 * GetParam().minutes);
    const std::int64_t held_us = rig_.now().us;
    // (Of a transfer that is under way it is too late.)
    rig_.bus(0).inject({.kind = sim::I2cFaultKind::sda_stuck_low,
                        .first = rig_.bus(0).transfer_count() + 1,
                        .position = clocks});
    rig_.run_for(duration() / 2);
    ASSERT_TRUE(rig_.bus(0).is_held());
    EXPECT_EQ(rig_.last_health(0)->fault, wire::SensorFault::bus_error);
    while (rig_.bus(0).is_held()) rig_.run_for(10 * kMillisecond);
    const std::int64_t free_us = rig_.now().us;
    EXPECT_NEAR(static_cast<double>(free_us - held_us), static_cast<double>(duration().count()), 10e6);
    rig_.run_for(20 * kSecond);
    expect_all_range();
    for (const std::uint8_t sensor : std::array<std::uint8_t, 2>{0, 2}) {
        EXPECT_LE(longest_gap_us(rig_, sensor, free_us), kBusBackUs) << int{sensor};
    }
    for (const std::uint8_t sensor : std::array<std::uint8_t, 2>{1, 3}) {
        EXPECT_LE(longest_gap_us(rig_, sensor, held_us), 2 * kSlowPeriodUs) << "the other bus";
    }
    EXPECT_LE(longest_silence_us(rig_, 0), 110'000);
}

TEST_P(LongFaultTest, F4_sensors_dead_for_long_are_back_after_the_longest_wait_between_attempts) {
    rig_.sensor(0).set_faults({.is_absent = true});
    rig_.sensor(1).set_faults({.never_ready = true});
    rig_.sensor(2).set_faults({.freezes_stream = true});
    rig_.sensor(3).set_faults({.never_boots = true});
    rig_.sensor(3).brown_out(rig_.now());
    rig_.run_for(duration());
    const std::int64_t mended_us = rig_.now().us;
    for (std::size_t sensor = 0; sensor < kSensors; ++sensor) rig_.sensor(sensor).set_faults({});
    // What was begun before may still fail: an attempt on a part that does not boot lasts half a second, on
    // one that is never ready three periods. Then 10 s, and the way up.
    rig_.run_for(40 * kSecond);
    expect_all_range();
    for (std::uint8_t sensor = 0; sensor < kSensors; ++sensor) {
        EXPECT_LE(longest_gap_us(rig_, sensor, mended_us), 4 * kSlowPeriodUs + 10'000'000 + kBusBackUs)
            << int{sensor};
    }
    EXPECT_LE(longest_silence_us(rig_, 0), 110'000);
}

// A bus without anybody, or a node shut out of it: what was to be said long ago is not said, and what is new
// is.
TEST_P(LongFaultTest, F4_a_node_that_nobody_heard_for_long_speaks_at_once_and_says_nothing_old) {
    rig_.send_from_host(wire::Command{.code = wire::CommandCode::send_black_box}, 5);
    rig_.run_for(200 * kMillisecond);
    const std::size_t pieces = rig_.said_of<wire::BlackBox>().size();
    ASSERT_GE(pieces, 1U);
    rig_.block_transmission(true);
    rig_.run_for(duration());
    rig_.block_transmission(false);
    const std::int64_t open_us = rig_.now().us;
    rig_.run_for(10 * kSecond);
    expect_all_range();
    EXPECT_LE(longest_silence_us(rig_, open_us), 110'000);
    EXPECT_GE(rig_.said_of<wire::BlackBox>().size(), pieces + 100) << "20 a second, where it had stopped";
    for (std::uint8_t sensor = 0; sensor < kSensors; ++sensor) {
        EXPECT_LE(longest_gap_us(rig_, sensor, open_us), 2 * kSlowPeriodUs) << int{sensor};
    }
}

TEST_P(LongFaultTest, F4_a_black_box_comes_after_a_fault_however_long_the_last_one_is_ago) {
    const auto dumps = [&] {
        return std::ranges::count(rig_.said_of<wire::BlackBox>(), 0U, &wire::BlackBox::index);
    };
    rig_.sensor(0).brown_out(rig_.now());
    rig_.run_for(kMinute);
    EXPECT_EQ(dumps(), 1);
    rig_.run_for(duration());
    rig_.sensor(0).brown_out(rig_.now());
    rig_.run_for(kMinute);
    EXPECT_EQ(dumps(), 2);
}

TEST_P(LongFaultTest, F4_an_order_to_reinitialise_given_while_the_bus_is_held_is_obeyed_once_it_is_free) {
    const auto clocks = static_cast<std::uint32_t>(9 * 60 * GetParam().minutes);
    rig_.bus(0).inject({.kind = sim::I2cFaultKind::sda_stuck_low,
                        .first = rig_.bus(0).transfer_count(),
                        .position = clocks});
    rig_.run_for(kMinute);
    rig_.send_from_host(wire::Command{.code = wire::CommandCode::reinitialise_sensor, .sensor = 2}, 5);
    while (rig_.bus(0).is_held()) rig_.run_for(100 * kMillisecond);
    const std::int64_t free_us = rig_.now().us;
    rig_.run_for(20 * kSecond);
    expect_all_range();
    EXPECT_LE(longest_gap_us(rig_, 2, free_us), kBusBackUs);
}

// Three resets, then a minute of silence: the clock wraps within it, or the node has been up for long before.
TEST_P(LongFaultTest, F4_safe_mode_lasts_its_minute_and_ends) {
    rig_.run_for(duration() - 3 * kSecond);
    for (int i = 0; i < 3; ++i) {
        rig_.run_for(kSecond);
        ASSERT_NE(rig_.node().state(), NodeState::safe) << i;
        rig_.reset({.cause = wire::ResetCause::watchdog});
    }
    const std::int64_t safe_us = rig_.now().us;
    ASSERT_EQ(rig_.node().state(), NodeState::safe);
    rig_.run_for(59'800 * kMillisecond);
    EXPECT_EQ(rig_.node().state(), NodeState::safe);
    EXPECT_EQ(rig_.said_of<wire::Heartbeat>().back().state, NodeState::safe);
    for (std::uint8_t sensor = 0; sensor < kSensors; ++sensor) {
        const auto readings = rig_.readings_of(sensor);
        EXPECT_LE(readings.back().end.us, safe_us + 1'000);
    }
    rig_.run_for(400 * kMillisecond);
    EXPECT_EQ(rig_.node().state(), NodeState::starting);
    rig_.run_for(10 * kSecond);
    expect_all_range();
    EXPECT_LE(longest_silence_us(rig_, safe_us), 110'000);
}

INSTANTIATE_TEST_SUITE_P(ReliabilityF4, LongFaultTest,
                         testing::Values(Case{"of_40_minutes_with_the_wrap_before_it", 40, 0},
                                         Case{"of_40_minutes_with_the_wrap_in_it", 40, 20},
                                         Case{"of_40_minutes_with_the_wrap_at_its_end", 40, 41},
                                         Case{"of_75_minutes", 75, 30}),
                         [](const auto& of) { return std::string(of.param.name); });

}  // namespace
}  // namespace octoskin::test
