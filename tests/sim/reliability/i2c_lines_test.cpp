// I2, I3: lines of an I2C bus that a device holds. Which test shows which row: docs/reference/reliability.md.
#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "tests/sim/reliability/six_sensors.hpp"
#include "tests/support/idle_ports.hpp"

namespace octoskin::test {
namespace {

using sim::I2cFaultKind;
using wire::SensorFault;

using LinesTest = SixSensorsTest;

// I2: told or freed within 10 ms, whenever it happens; the other bus and the heartbeat go on.
TEST(ReliabilityI2, sda_held_low_is_freed_by_nine_clocks_or_told_within_10_ms) {
    for (const std::uint32_t clocks : {1U, 9U, 18U, 1'000'000U}) {
        for (int phase_ms = 0; phase_ms < 33; phase_ms += 3) {
            NodeRig rig = NodeRig(fleet_config(kSensors, 2), std::vector<SensorSetup>(kSensors),
                                  wraps_after(2 * kSecond + (phase_ms + 4) * kMillisecond));
            rig.run_for(2 * kSecond + phase_ms * kMillisecond);  // up and trimmed
            // One may be under way.
            const std::uint64_t first = rig.bus(0).transfer_count() + 1;
            rig.bus(0).inject({.kind = I2cFaultKind::sda_stuck_low, .first = first, .position = clocks});
            while (rig.bus(0).transfer_count() <= first) rig.run_for(Microseconds{100});
            const std::int64_t hurt_us = rig.now().us;
            const bool is_freed_at_once = clocks <= 18;  // nine clocks for the transfer, nine for its retry
            const std::uint32_t restarts = rig.node().counts().sensor_restarts;
            rig.run_for(10 * kMillisecond);
            if (is_freed_at_once) {
                EXPECT_EQ(rig.node().counts().sensor_restarts, restarts);
            } else {
                for (const std::uint8_t sensor : kOnItsBus) {
                    EXPECT_EQ(rig.last_health(sensor)->fault, SensorFault::bus_error) << clocks;
                }
            }
            rig.run_for(1 * kSecond);
            for (const std::uint8_t sensor : kOnTheOtherBus) {
                EXPECT_LE(longest_gap_us(rig, sensor, hurt_us), 2 * kPeriodUs);
            }
            EXPECT_LE(longest_silence_us(rig, hurt_us), 110'000);
        }
    }
}

TEST_P(LinesTest, I2_a_sensor_that_holds_sda_costs_its_bus_no_longer_than_xshut_needs) {
    rig_.sensor(kHurt).set_faults({.holds_sda_clocks = 1'000'000});
    rig_.run_for(50 * kMillisecond);
    // Isolated, so the bus is free again: the others are being brought up.
    EXPECT_EQ(rig_.node().state(), wire::NodeState::ranging);
    rig_.run_for(2 * kSecond);
    expect_all_range();
    for (const std::uint8_t sensor : kOnItsBus) {
        EXPECT_LE(longest_gap_us(rig_, sensor, hurt_us_), 50'000 + kReinitialisedUs) << int{sensor};
    }
    EXPECT_LE(longest_silence_us(rig_, hurt_us_), 110'000);
}

/// A bus that notes what deadline each transfer gets.
class DeadlineBus final : public i2c::Bus {
  public:
    DeadlineBus(i2c::Bus& bus, std::uint32_t hz) : bus_(bus), hz_(hz) {}
    [[nodiscard]] bool is_busy() const override { return bus_.is_busy(); }
    void submit(const i2c::Transfer& transfer, NodeTime now, NodeTime deadline) override {
        // By hand: 9 clocks a byte, address and repeated address with them, START and STOP.
        const std::size_t written = transfer.write.size();
        const std::size_t read = transfer.read.size();
        const std::size_t bits = read == 0 ? 9 * (1 + written) + 2 : 9 * (2 + written + read) + 3;
        const double nominal_us = static_cast<double>(bits) * 1e6 / hz_;
        const auto limit_us = static_cast<double>(elapsed(now, deadline).count());
        EXPECT_GE(limit_us, 3 * nominal_us + 1'000);
        EXPECT_LE(limit_us, 3 * nominal_us + 1'003);
        ++transfers;
        bus_.submit(transfer, now, deadline);
    }
    [[nodiscard]] i2c::TransferState poll(NodeTime now) override { return bus_.poll(now); }
    [[nodiscard]] i2c::TransferError error() const override { return bus_.error(); }
    bool recover() override { return bus_.recover(); }
    std::uint64_t transfers = 0;

  private:
    i2c::Bus& bus_;
    std::uint32_t hz_;
};

TEST(ReliabilityI3, every_transfer_gets_three_times_its_nominal_time_and_a_millisecond) {
    for (const std::uint32_t hz : {100'000U, 283'000U, 400'000U}) {
        sim::Present present;
        sim::SimulatedI2cBus bus(present, hz);
        sim::SensorModel sensor({}, [](std::uint32_t, sim::SimTime, const Roi&) {
            return sim::RangingReturn{
                .range_m = 1.0, .sigma_m = 0.005, .peak_signal_mcps = 10.0, .ambient_mcps = 0.5};
        });
        sensor.set_xshut(true, present.time);  // at 0x29 from the start: it is parked first, then stuck
        bus.attach(sensor);
        DeadlineBus watched(bus, hz);
        std::array<i2c::Bus*, 1> buses = {&watched};
        NoLines lines;
        NoCan can;
        NodeConfig config = fleet_config(1, 1);
        config.i2c_hz = hz;
        node::Node node(config, {}, {.buses = buses, .xshut = lines, .can = can}, NodeTime{});
        for (; present.time.us < 200'000; present.time.us += 50) {
            node.poll(NodeTime{static_cast<std::uint32_t>(present.time.us)});
        }
        EXPECT_GT(watched.transfers, 10U);
    }
}

TEST_P(LinesTest, I3_a_clock_stretched_without_end_is_given_up_counted_and_recovered_from) {
    const std::uint32_t errors = rig_.node().counts().i2c_errors;
    rig_.bus(0).inject(
        {.kind = I2cFaultKind::stretch, .first = rig_.bus(0).transfer_count() + 3, .count = 2});
    rig_.run_for(2 * kSecond);
    EXPECT_EQ(rig_.node().counts().i2c_errors, errors + 2);
    expect_all_range();
    EXPECT_LE(longest_silence_us(rig_, hurt_us_), 110'000);
    for (const std::uint8_t sensor : kOnTheOtherBus) {
        EXPECT_LE(longest_gap_us(rig_, sensor, hurt_us_), 2 * kPeriodUs);
    }
}

INSTANTIATE_TEST_SUITE_P(Reliability, LinesTest, wraps(), wrap_name);

}  // namespace
}  // namespace octoskin::test
