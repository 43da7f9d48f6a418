// The rows "Sensor and I2C" of the reliability goals, each fault injected into a node in simulation. Which
// test shows which row: docs/reliability.md.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "common/range_status.hpp"
#include "tests/sim/reliability/oracles.hpp"

namespace octoskin::test {
namespace {

using sim::I2cFaultKind;
using wire::SensorFault;
using wire::SensorState;

/// Three sensors on a bus, the middle one to be hurt; one on another.
constexpr std::uint8_t kHurt = 2;
constexpr std::uint8_t kSensors = 6;
constexpr std::array<std::uint8_t, 3> kOnItsBus = {0, 2, 4};

class ReliabilityTest : public testing::Test {
  protected:
    ReliabilityTest() : rig_(fleet_config(kSensors, 2), std::vector<SensorSetup>(kSensors), kWrapsAfter5s) {
        rig_.run_for(2 * kSecond);
        hurt_us_ = rig_.now().us;
    }
    /// None but its own readings may suffer.
    void expect_neighbours_undisturbed() {
        for (std::uint8_t sensor = 0; sensor < kSensors; ++sensor) {
            if (sensor == kHurt) continue;
            EXPECT_EQ(rig_.last_health(sensor)->state, SensorState::ranging) << int{sensor};
            EXPECT_LE(longest_gap_us(rig_, sensor, hurt_us_), 2 * kPeriodUs + 5'000) << int{sensor};
        }
    }
    void expect_all_range() {
        for (std::uint8_t sensor = 0; sensor < kSensors; ++sensor) {
            EXPECT_EQ(rig_.last_health(sensor)->state, SensorState::ranging) << int{sensor};
            EXPECT_LE(longest_gap_us(rig_, sensor, rig_.now().us - 500'000), 2 * kPeriodUs) << int{sensor};
            expect_only_the_truth(rig_, sensor);
        }
        EXPECT_EQ(rig_.said_of<wire::Heartbeat>().back().degraded_sensors, 0);
    }
    NodeRig rig_;
    std::int64_t hurt_us_ = 0;
};

struct Nack {
    I2cFaultKind kind;
    std::uint32_t position;
};
constexpr std::array<Nack, 5> kNacks = {{{I2cFaultKind::nack_address, 0},
                                         {I2cFaultKind::nack_byte, 0},
                                         {I2cFaultKind::nack_byte, 1},
                                         {I2cFaultKind::nack_byte, 2},
                                         {I2cFaultKind::nack_read, 0}}};

/// How many transfers a sensor alone on its bus takes to its third reading.
std::uint64_t transfers_to_third_reading() {
    NodeRig rig(fleet_config(1, 1), std::vector<SensorSetup>(1));
    while (rig.readings_of(0).size() < 3) rig.run_for(kMillisecond);
    return rig.bus(0).transfer_count();
}

// I1: once, anywhere from the first transfer on: the retry makes it as if nothing had been.
TEST(ReliabilityI1, a_nack_of_any_byte_of_any_transfer_costs_one_retry) {
    const std::uint64_t transfers = transfers_to_third_reading();
    ASSERT_GT(transfers, 30U);
    for (const Nack& nack : kNacks) {
        for (std::uint64_t first = 0; first < transfers; ++first) {
            NodeRig rig(fleet_config(1, 1), std::vector<SensorSetup>(1), kWrapsAfter5s);
            rig.bus(0).inject({.kind = nack.kind, .first = first, .position = nack.position});
            rig.run_for(400 * kMillisecond);
            EXPECT_EQ(rig.node().counts().sensor_restarts, 0U) << first;
            EXPECT_LE(rig.node().counts().i2c_errors, 1U) << first;
            EXPECT_EQ(rig.last_health(0)->state, SensorState::ranging) << first;
            expect_only_the_truth(rig, 0);
        }
    }
}

// I1: twice, and the sensor is lost; it comes back by itself, and its neighbour notices nothing.
TEST(ReliabilityI1, a_transfer_refused_twice_loses_that_sensor_alone_and_for_a_moment) {
    for (const Nack& nack : kNacks) {
        for (std::uint64_t offset = 0; offset < 24; ++offset) {
            NodeRig rig(fleet_config(2, 1), std::vector<SensorSetup>(2), kWrapsAfter5s);
            rig.run_for(1 * kSecond);
            const std::int64_t hurt_us = rig.now().us;
            rig.bus(0).inject({.kind = nack.kind,
                               .first = rig.bus(0).transfer_count() + offset,
                               .count = 12,
                               .position = nack.position,
                               .address = 0x31});
            rig.run_for(1 * kSecond);
            EXPECT_LE(longest_gap_us(rig, 1, hurt_us), kReinitialisedUs) << offset;
            EXPECT_LE(longest_gap_us(rig, 0, hurt_us), 2 * kPeriodUs + 5'000) << offset;
            EXPECT_EQ(rig.last_health(1)->state, SensorState::ranging) << offset;
            for (const std::uint8_t sensor : std::array<std::uint8_t, 2>{0, 1})
                expect_only_the_truth(rig, sensor);
        }
    }
}

TEST(ReliabilityI1, a_sensor_that_never_answers_is_absent_and_one_that_did_is_lost) {
    std::vector<SensorSetup> setups(2);
    setups[1].is_fitted = false;
    NodeRig rig(fleet_config(2, 1), setups);
    rig.run_for(1 * kSecond);
    EXPECT_EQ(rig.last_health(1)->state, SensorState::absent);
    rig.sensor(0).set_faults({.is_absent = true});
    rig.run_for(1 * kSecond);
    EXPECT_EQ(rig.last_health(0)->state, SensorState::lost);
    EXPECT_EQ(rig.said_of<wire::Heartbeat>().back().degraded_sensors, 2);
}

// I2: told or freed within 10 ms, whenever it happens; the other bus and the heartbeat go on.
TEST(ReliabilityI2, sda_held_low_is_freed_by_nine_clocks_or_told_within_10_ms) {
    for (const std::uint32_t clocks : {1U, 9U, 18U, 1'000'000U}) {
        for (int phase_ms = 0; phase_ms < 33; phase_ms += 3) {
            NodeRig rig = NodeRig(fleet_config(kSensors, 2), std::vector<SensorSetup>(kSensors));
            rig.run_for(1 * kSecond + phase_ms * kMillisecond);
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
            for (const std::uint8_t sensor : std::array<std::uint8_t, 3>{1, 3, 5}) {
                EXPECT_LE(longest_gap_us(rig, sensor, hurt_us), 2 * kPeriodUs);
            }
            EXPECT_LE(longest_silence_us(rig, hurt_us), 110'000);
        }
    }
}

TEST_F(ReliabilityTest, I2_a_sensor_that_holds_sda_costs_its_bus_no_longer_than_xshut_needs) {
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

class NoLines final : public node::XshutLines {
    void set(std::uint8_t, bool) override {}
};
class NoCan final : public node::CanTransmitter {
    bool send(const wire::CanFrame&) override { return true; }
    [[nodiscard]] node::CanState state() const override { return node::CanState::active; }
    void discard() override {}
    std::optional<wire::CanFrame> take_given_up() override { return std::nullopt; }
    void restart() override {}
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

TEST_F(ReliabilityTest, I3_a_clock_stretched_without_end_is_given_up_counted_and_recovered_from) {
    const std::uint32_t errors = rig_.node().counts().i2c_errors;
    rig_.bus(0).inject(
        {.kind = I2cFaultKind::stretch, .first = rig_.bus(0).transfer_count() + 3, .count = 2});
    rig_.run_for(2 * kSecond);
    EXPECT_EQ(rig_.node().counts().i2c_errors, errors + 2);
    expect_all_range();
    EXPECT_LE(longest_silence_us(rig_, hurt_us_), 110'000);
    for (const std::uint8_t sensor : std::array<std::uint8_t, 3>{1, 3, 5}) {
        EXPECT_LE(longest_gap_us(rig_, sensor, hurt_us_), 2 * kPeriodUs);
    }
}

// I4: the device lets go after byte number 0..16 of one of a result's two reads; all that follows reads as
// ones.
TEST(ReliabilityI4, a_read_cut_short_at_any_byte_makes_no_measurement) {
    NodeRig rig(fleet_config(2, 1), std::vector<SensorSetup>(2), kWrapsAfter5s);
    rig.run_for(1 * kSecond);
    for (std::uint32_t position = 0; position < 17; ++position) {
        for (std::uint64_t which = 0; which < 12; ++which) {
            rig.bus(0).inject({.kind = I2cFaultKind::read_ones,
                               .first = rig.bus(0).transfer_count() + which,
                               .position = position});
            rig.run_for(100 * kMillisecond);
        }
    }
    for (const std::uint8_t sensor : std::array<std::uint8_t, 2>{0, 1}) expect_only_the_truth(rig, sensor);
    EXPECT_GT(rig.node().counts().reads_disagreed, 0U);
}

// I5: one bit of any read, poll and read-back of a zone included, in every phase of a reading.
TEST(ReliabilityI5, no_bit_flipped_in_any_read_ever_makes_a_distance_that_was_not_measured) {
    for (std::uint64_t which = 0; which < 8; ++which) {
        NodeRig rig(fleet_config(1, 1), std::vector<SensorSetup>(1), kWrapsAfter5s);
        rig.run_for(500 * kMillisecond);
        for (std::uint32_t bit = 0; bit < 136; ++bit) {
            rig.bus(0).inject({.kind = I2cFaultKind::flip_bit,
                               .first = rig.bus(0).transfer_count() + which,
                               .position = bit});
            rig.run_for(70 * kMillisecond);
        }
        expect_only_the_truth(rig, 0);
    }
}

TEST_F(ReliabilityTest, I7_one_sensor_that_browned_out_is_back_within_the_figure) {
    rig_.sensor(kHurt).brown_out(rig_.now());
    rig_.run_for(2 * kSecond);
    EXPECT_LE(longest_gap_us(rig_, kHurt, hurt_us_), kReinitialisedUs);
    expect_neighbours_undisturbed();
    expect_all_range();
}

TEST_F(ReliabilityTest, I7_all_sensors_that_browned_out_together_are_back_within_the_figure) {
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
    rig.run_for(1 * kSecond);
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
TEST_F(ReliabilityTest, I10_frozen_data_is_stale_after_three_periods_and_never_repeated) {
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

TEST_F(ReliabilityTest, I10_a_sensor_that_is_never_ready_is_reinitialised_after_three_periods) {
    rig_.sensor(kHurt).set_faults({.never_ready = true});
    rig_.run_for(5 * kPeriodUs * Microseconds{1});
    EXPECT_GE(rig_.node().counts().sensor_restarts, 1U);
    EXPECT_EQ(rig_.last_health(kHurt)->fault, SensorFault::no_data_ready);
    const std::size_t readings = rig_.readings_of(kHurt).size();
    rig_.run_for(1 * kSecond);
    EXPECT_EQ(rig_.readings_of(kHurt).size(), readings);
    expect_neighbours_undisturbed();
}

// I11: the node hands every status and every distance on as it is; only "complete" of a first result, whose
// wrap-around was not checked, gets the code that says so. (What becomes a ray is the host's, tested there.)
TEST(ReliabilityI11, every_status_and_every_distance_goes_on_the_wire_as_it_is) {
    node::Policy policy;
    const node::ZoneCycle zones(1, Microseconds{1'000});
    std::uint64_t accepted = 0;
    for (std::uint8_t status = 0; status < 32; ++status) {
        node::Acceptance acceptance(StreamGate::advanced, Microseconds{20'000}, policy);
        NodeTime now{0xFFFF'FFFFU - 5'000'000U};
        acceptance.restart(now, Microseconds{33'000}, 10);
        std::uint8_t stream = 0;
        for (std::uint32_t range_mm = 0; range_mm <= 65'535; ++range_mm) {
            now = now + Microseconds{33'000};
            acceptance.on_not_ready(now - Microseconds{100});
            vl53l1x::Measurement measurement;
            measurement.device_status = status;
            measurement.range_mm = static_cast<std::uint16_t>(range_mm);
            measurement.stream_count = stream;
            const auto verdict =
                acceptance.judge({.measurement = measurement, .ready_seen = now, .read_end = now}, zones);
            ASSERT_EQ(verdict, node::Verdict::accepted);
            const bool is_unchecked = stream == 0 && status == 9;
            ASSERT_EQ(acceptance.reading().device_status, is_unchecked ? 19 : status);
            ASSERT_EQ(acceptance.reading().range_mm, range_mm);
            ++accepted;
            stream = stream == 255 ? 128 : static_cast<std::uint8_t>(stream + 1);
        }
    }
    EXPECT_EQ(accepted, 32U * 65'536U);
}

// I12: at 200 instants of a busy bus; the sensors keep power, addresses, and whatever byte they were sending.
TEST(ReliabilityI12, a_controller_reset_in_mid_transfer_starts_cleanly) {
    for (const bool is_xshut_kept : {false, true}) {
        NodeRig rig(fleet_config(4, 1), std::vector<SensorSetup>(4), kWrapsAfter5s);
        rig.run_for(1 * kSecond);
        for (int i = 0; i < 100; ++i) {
            rig.run_for(Microseconds{700'000 + 337 * i});
            rig.reset({.cause = wire::ResetCause::pin, .is_xshut_kept = is_xshut_kept});
            const std::int64_t reset_us = rig.now().us;
            rig.run_for(400 * kMillisecond);
            for (std::uint8_t sensor = 0; sensor < 4; ++sensor) {
                ASSERT_EQ(rig.last_health(sensor)->state, SensorState::ranging) << i << ' ' << int{sensor};
                const auto readings = rig.readings_of(sensor);
                ASSERT_GT(readings.back().end.us, reset_us);
            }
        }
        for (std::uint8_t sensor = 0; sensor < 4; ++sensor) expect_only_the_truth(rig, sensor);
        EXPECT_EQ(rig.node().counts().sensor_restarts, 0U);
    }
}

// I13: the re-initialisation after a brown-out fails at its first, second, ... transfer: the next attempt,
// and the readings after it, are those of a sensor that starts from nothing.
TEST(ReliabilityI13, a_reinitialisation_that_fails_at_any_transfer_is_followed_by_a_clean_one) {
    for (std::uint64_t failing = 0; failing < 60; ++failing) {
        NodeRig rig(fleet_config(2, 1), std::vector<SensorSetup>(2), kWrapsAfter5s);
        rig.run_for(600 * kMillisecond);
        const std::int64_t hurt_us = rig.now().us;
        rig.sensor(1).brown_out(rig.now());
        rig.bus(0).inject(
            {.kind = I2cFaultKind::nack_address, .first = rig.bus(0).transfer_count() + failing, .count = 2});
        rig.run_for(1'500 * kMillisecond);
        for (const std::uint8_t sensor : std::array<std::uint8_t, 2>{0, 1}) {
            EXPECT_EQ(rig.last_health(sensor)->state, SensorState::ranging) << failing;
            EXPECT_LE(longest_gap_us(rig, sensor, hurt_us), 2 * kReinitialisedUs) << failing;
            expect_only_the_truth(rig, sensor);
        }
        EXPECT_EQ(rig.last_health(1)->fault == SensorFault::address_conflict, false);
    }
}

}  // namespace
}  // namespace octoskin::test
