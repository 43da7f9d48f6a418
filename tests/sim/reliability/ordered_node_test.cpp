// A node that is given orders in any order, by its host and by another node that speaks under its id, while
// its buses fail now and then and its sensors lose their supply.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "tests/sim/reliability/oracles.hpp"
#include "tests/support/turns.hpp"

namespace octoskin::test {
namespace {

using sim::I2cFaultKind;
using wire::Command;
using wire::CommandCode;

constexpr wire::NodeId kOwnId = 5;
constexpr std::uint8_t kSensors = 6;
constexpr std::uint8_t kBuses = 2;

class Draw {
  public:
    explicit Draw(std::uint32_t seed) : random_(seed) {}
    /// From 0 to `count` - 1.
    std::uint32_t operator()(std::uint32_t count) { return static_cast<std::uint32_t>(random_() % count); }
    template <class Value, std::size_t kCount>
    Value one_of(const std::array<Value, kCount>& values) {
        return values.at((*this)(kCount));
    }

  private:
    std::mt19937 random_;
};

NodeConfig any_config(Draw& draw) {
    NodeConfig config = fleet_config(kSensors, kBuses);
    config.holds_phases = draw(2) == 0;
    config.data_ready_buses = static_cast<std::uint8_t>(draw(1U << kBuses));
    config.uses_can_fd = draw(2) == 0;
    if (draw(2) == 0) spread_phases(config);
    for (std::uint8_t i = 0; i < kSensors; i = static_cast<std::uint8_t>(i + 2)) {
        config.sensors.at(i).zone_count = 2;
        config.sensors.at(i).zones[0] = {.centre_spad = 167, .width = 8, .height = 16};
        config.sensors.at(i).zones[1] = {.centre_spad = 231, .width = 8, .height = 8};
    }
    return config;
}

std::vector<SensorSetup> any_parts(Draw& draw) {
    std::vector<SensorSetup> setups(kSensors);
    for (SensorSetup& setup : setups) {
        setup.part.slow_clock_factor = 1.0 + 0.0001 * draw(1'600);
        setup.part.range_overhead = Microseconds{draw(4'900)};
        setup.part.is_restarted_by_start = draw(2) == 0;
    }
    return setups;
}

class OrderedNode {
  public:
    explicit OrderedNode(std::uint32_t seed)
        : draw_(seed),
          config_(any_config(draw_)),
          rig_(config_, any_parts(draw_), sim::NodeClock{{0xFFFF'FFFFU - draw_(8'000'000U)}, 50.0}),
          has_faults_(draw_(2) == 0) {}

    void give_orders() {
        for (int step = 0; step < 160; ++step) {
            rig_.run_for(Microseconds{1'000 + draw_(100'000)});
            if (draw_(2) == 0) order_anything();
            if (has_faults_ && draw_(4) == 0) break_something();
        }
    }
    /// Faults and calibrations end; then everything is as configured again.
    void order_all_back() {
        rig_.run_for(6 * kSecond);
        send({.code = CommandCode::set_rate, .sensor = wire::kAllSensors});
        rig_.run_for(kMillisecond);
        send({.code = CommandCode::start, .sensor = wire::kAllSensors});
        rig_.run_for(30 * kSecond);
    }
    void expect_whole() {
        EXPECT_EQ(rig_.node().state(), wire::NodeState::ranging);
        for (std::uint8_t sensor = 0; sensor < kSensors; ++sensor) {
            SCOPED_TRACE("sensor " + std::to_string(sensor));
            expect_only_the_truth(rig_, sensor);
            const auto& readings = rig_.readings_of(sensor);
            const auto of_last_seconds = std::ranges::count_if(
                readings, [&](const auto& said) { return said.end.us > rig_.now().us - 3'300'000; });
            EXPECT_GE(of_last_seconds, 85) << "of 100, less what holding phases gives up";
            EXPECT_EQ(rig_.last_health(sensor)->state, wire::SensorState::ranging);
        }
        expect_readings_accounted_for(rig_.node());
    }

  private:
    void send(Command command) {
        command.sequence = ++sequence_;
        rig_.send_from_host(command, kOwnId);
    }
    void order_anything() {
        constexpr std::array kCodes = {CommandCode::start,
                                       CommandCode::stop,
                                       CommandCode::set_rate,
                                       CommandCode::reinitialise_sensor,
                                       CommandCode::send_black_box,
                                       CommandCode::calibrate_offset,
                                       CommandCode::calibrate_crosstalk};
        if (draw_(9) == 0) {  // another node under its id
            rig_.send_from_host(wire::Heartbeat{.uid_crc = 1}, kOwnId);
            return;
        }
        Command command{.code = draw_.one_of(kCodes), .sensor = static_cast<std::uint8_t>(draw_(kSensors))};
        const bool is_calibration =
            command.code == CommandCode::calibrate_offset || command.code == CommandCode::calibrate_crosstalk;
        if (is_calibration) {
            command.argument = 140;
        } else if (draw_(4) == 0) {
            command.sensor = wire::kAllSensors;
        }
        if (command.code == CommandCode::set_rate)
            command.argument = static_cast<std::uint16_t>(draw_(4) == 0 ? 0 : 25 + draw_(200));
        send(command);
    }
    void break_something() {
        constexpr std::array kKinds = {I2cFaultKind::nack_address,  I2cFaultKind::nack_byte,
                                       I2cFaultKind::nack_read,     I2cFaultKind::stretch,
                                       I2cFaultKind::sda_stuck_low, I2cFaultKind::lose_arbitration};
        sim::SimulatedI2cBus& bus = rig_.bus(draw_(kBuses));
        bus.inject({.kind = draw_.one_of(kKinds),
                    .first = bus.transfer_count() + draw_(40),
                    .count = 1 + draw_(3),
                    .position = 1 + draw_(30)});
        if (draw_(5) == 0) rig_.sensor(draw_(kSensors)).brown_out(rig_.now());
    }

    Draw draw_;
    NodeConfig config_;
    NodeRig rig_;
    bool has_faults_;
    std::uint8_t sequence_ = 0;
};

TEST(OrderedNodeTest,
     sends_nothing_but_the_truth_and_ranges_again_whatever_it_was_ordered_and_whatever_failed) {
    for (std::uint32_t seed = 1; seed <= 40; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        OrderedNode node(seed);
        node.give_orders();
        node.order_all_back();
        node.expect_whole();
    }
}

}  // namespace
}  // namespace octoskin::test
