// The rows "Firmware" of the reliability goals that the core keeps; F2, F3, F5 are the port's. Which test
// shows which row: docs/reference/reliability.md.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "tests/sim/reliability/oracles.hpp"
#include "tests/support/idle_ports.hpp"

namespace octoskin::test {
namespace {

using wire::Command;
using wire::CommandCode;
using wire::FaultKind;
using wire::NodeState;
using wire::ResetCause;
using wire::SensorState;

constexpr wire::NodeId kOwnId = 5;

class ReliabilityFirmwareTest : public testing::Test {
  protected:
    explicit ReliabilityFirmwareTest()
        : rig_(fleet_config(4, 2), std::vector<SensorSetup>(4), kWrapsAfter5s) {}

    [[nodiscard]] wire::Heartbeat heartbeat() const { return rig_.said_of<wire::Heartbeat>().back(); }
    void command(CommandCode code) {
        rig_.send_from_host(Command{.code = code, .sequence = sequence_++}, kOwnId);
    }
    /// Watchdog resets until the node goes into safe mode.
    void drive_into_safe_mode() {
        for (int i = 0; i < 3; ++i) {
            rig_.run_for(500 * kMillisecond);
            rig_.reset({.cause = ResetCause::watchdog});
        }
        rig_.run_for(10 * kMillisecond);
        ASSERT_EQ(rig_.node().state(), NodeState::safe);
    }
    NodeRig rig_;
    std::uint8_t sequence_ = 0;
};

// F1: the dog, whose bite comes 200 ms after the last feed, is fed in every state in which the loop turns.
TEST_F(ReliabilityFirmwareTest, F1_the_watchdog_is_fed_at_most_50_ms_apart_whatever_happens_on_the_buses) {
    rig_.bus(0).inject(
        {.kind = sim::I2cFaultKind::stretch, .first = rig_.bus(0).transfer_count() + 40, .count = 20});
    rig_.bus(1).inject({.kind = sim::I2cFaultKind::sda_stuck_low, .first = 60, .position = 1'000'000});
    rig_.run_for(8 * kSecond);
    drive_into_safe_mode();
    rig_.run_for(2 * kSecond);
    for (std::size_t i = 1; i < rig_.feeds().size(); ++i) {
        EXPECT_LE(rig_.feeds()[i].us - rig_.feeds()[i - 1].us, 50'000);
    }
    EXPECT_GE(rig_.feeds().back().us, rig_.now().us - 50'000);
}

// F1: a clock that stands still, though the loop turns.
TEST_F(ReliabilityFirmwareTest, F1_the_watchdog_starves_when_the_clock_stands_still) {
    rig_.run_for(500 * kMillisecond);
    const NodeTime stopped = rig_.node_now();
    rig_.node().poll(stopped);
    const std::size_t feeds = rig_.feeds().size();
    for (int i = 0; i < 100'000; ++i) rig_.node().poll(stopped);
    EXPECT_EQ(rig_.feeds().size(), feeds);
}

/// A bus whose interrupt has died: what is submitted never ends, not even at its deadline.
class DeafBus final : public i2c::Bus {
  public:
    [[nodiscard]] bool is_busy() const override { return is_busy_; }
    void submit(const i2c::Transfer&, NodeTime, NodeTime) override { is_busy_ = true; }
    [[nodiscard]] i2c::TransferState poll(NodeTime) override {
        return is_busy_ ? i2c::TransferState::pending : i2c::TransferState::idle;
    }
    [[nodiscard]] i2c::TransferError error() const override { return i2c::TransferError::timeout; }
    bool recover() override { return true; }

  private:
    bool is_busy_ = false;
};
class CountingDog final : public node::Watchdog {
  public:
    NodeTime now;
    NodeTime last_fed;

  private:
    void feed() override { last_fed = now; }
};

TEST(ReliabilityFirmware,
     F1_the_watchdog_starves_when_a_transfer_never_ends_and_the_bus_cannot_be_recovered) {
    DeafBus bus;
    std::array<i2c::Bus*, 1> buses = {&bus};
    NoLines lines;
    NoCan can;
    CountingDog dog;
    node::Node node(fleet_config(1, 1), {}, {.buses = buses, .xshut = lines, .can = can, .watchdog = &dog},
                    NodeTime{});
    for (std::uint32_t us = 0; us < 2'000'000; us += 100) {
        dog.now = NodeTime{us};
        node.poll(dog.now);
    }
    // The first transfer begins a millisecond after the start and may take some; then 100 ms of patience.
    EXPECT_LE(dog.last_fed.us, 130'000U);
}

TEST_F(ReliabilityFirmwareTest, F1_the_first_heartbeat_after_a_reset_tells_the_cause_and_outputs_are_silent) {
    for (const ResetCause cause : {ResetCause::watchdog, ResetCause::brown_out, ResetCause::pin,
                                   ResetCause::software, ResetCause::unknown, ResetCause::power_on}) {
        rig_.run_for(11 * kSecond);
        rig_.hang_for(200 * kMillisecond);
        const std::size_t beats = rig_.said_of<wire::Heartbeat>().size();
        const std::size_t said = rig_.said().size();
        const std::int64_t reset_us = rig_.now().us;
        rig_.reset({.cause = cause, .takes = 20 * kMillisecond});
        EXPECT_EQ(rig_.said().size(), said) << "nobody speaks in reset";
        rig_.run_for(280 * kMillisecond);
        ASSERT_GT(rig_.said_of<wire::Heartbeat>().size(), beats);
        EXPECT_EQ(rig_.said_of<wire::Heartbeat>().at(beats).reset_cause, cause);
        EXPECT_LE(rig_.times_of<wire::Heartbeat>().at(beats).us - reset_us, 300'000);
        rig_.run_for(1'700 * kMillisecond);
        EXPECT_GE(rig_.readings_of(0).back().end.us, reset_us) << "first range within 2 s";
    }
}

// F4: everything at 10,000 instants about the wrap: no jump of a capture time, no stale verdict, even beats.
TEST(ReliabilityFirmware, F4_the_wrap_of_the_clock_changes_nothing) {
    const auto readings_with = [](const sim::NodeClock& clock) {
        NodeRig rig(fleet_config(6, 2), std::vector<SensorSetup>(6), clock);
        rig.run_for(12 * kSecond);
        EXPECT_EQ(rig.node().counts().sensor_restarts, 0U);
        EXPECT_EQ(rig.node().counts().rejected, 0U);
        EXPECT_EQ(rig.node().counts().late, 0U);
        EXPECT_LE(longest_silence_us(rig, 0), 110'000);
        for (std::uint8_t sensor = 0; sensor < 6; ++sensor) {
            expect_only_the_truth(rig, sensor);
            // Each is stopped and started once, to trim its period, and may just miss its place in the grid.
            EXPECT_LE(longest_gap_us(rig, sensor, 500'000), 3 * kPeriodUs) << int{sensor};
            EXPECT_LE(longest_gap_us(rig, sensor, 2'000'000), kPeriodUs * 11 / 10) << int{sensor};
            for (const SaidReading& said : rig.readings_of(sensor)) {
                const TrueRange& truth =
                    *std::ranges::find(rig.truth(sensor), said.reading.range_mm, &TrueRange::range_mm);
                const std::uint32_t captured = rig.clock().to_node(truth.window_middle).us;
                const auto error =
                    static_cast<std::int32_t>((said.reading.capture.value_us - captured) << 8U);
                EXPECT_LE(std::abs(error / 256), 2'000) << said.end.us;
            }
        }
        return rig.readings_of(0).size();
    };
    const std::size_t usual = readings_with(sim::NodeClock{{1'000'000U}, 0.0});
    // Sensors start on a grid of the clock, which shifts at the wrap: no more than one reading differs.
    EXPECT_NEAR(static_cast<double>(readings_with(kWrapsAfter5s)), static_cast<double>(usual), 2.0);
}

TEST_F(ReliabilityFirmwareTest, F4_recovery_and_safe_mode_work_over_the_wrap) {
    rig_.run_for(4'900 * kMillisecond);
    rig_.sensor(1).brown_out(rig_.now());
    rig_.run_for(2 * kSecond);
    EXPECT_EQ(rig_.last_health(1)->state, SensorState::ranging);
    EXPECT_LE(longest_gap_us(rig_, 1, 4'900'000), kReinitialisedUs);
}

// F6
TEST_F(ReliabilityFirmwareTest, F6_a_recorded_fault_is_told_after_the_reset) {
    rig_.run_for(7'300 * kMillisecond);
    node::note_fault(rig_.kept(), FaultKind::hard_fault, 0x0800'4242);
    rig_.reset({.cause = ResetCause::software});
    rig_.run_for(1 * kSecond);
    EXPECT_EQ(heartbeat().reset_cause, ResetCause::fault);
    EXPECT_EQ(
        last_page<wire::InfoFault>(rig_),
        (wire::InfoFault{.kind = FaultKind::hard_fault, .count = 1, .where = 0x0800'4242, .uptime_s = 7}));
}

TEST_F(ReliabilityFirmwareTest, F6_three_resets_in_ten_seconds_leave_nothing_but_a_heartbeat_for_a_minute) {
    drive_into_safe_mode();
    const std::size_t beats = rig_.said_of<wire::Heartbeat>().size();
    const std::size_t said = rig_.said().size();
    const std::size_t lines = rig_.xshut_events().size();
    const std::uint64_t transfers = rig_.bus(0).transfer_count();
    rig_.send_from_host(wire::Sync{.sequence = 1}, wire::kHostId);
    rig_.run_for(59'900 * kMillisecond);
    EXPECT_EQ(rig_.said_of<wire::Heartbeat>().size(), beats + 599);
    EXPECT_EQ(rig_.said().size(), said + 599 + 1) << "heartbeats and our own SYNC";
    EXPECT_EQ(heartbeat().state, NodeState::safe);
    EXPECT_EQ(rig_.xshut_events().size(), lines);
    EXPECT_EQ(rig_.bus(0).transfer_count(), transfers);
    rig_.run_for(1 * kSecond);  // then it tries once more
    EXPECT_EQ(heartbeat().state, NodeState::ranging);
    EXPECT_EQ(last_page<wire::InfoFault>(rig_)->kind, FaultKind::watchdog);
    EXPECT_EQ(last_page<wire::InfoFault>(rig_)->count, 3);
}

// Found by the campaign: a node back from bus-off told so.
TEST_F(ReliabilityFirmwareTest, F6_safe_mode_stays_silent_over_bus_off) {
    drive_into_safe_mode();
    rig_.run_for(500 * kMillisecond);
    const std::size_t said = rig_.said().size();
    const std::size_t beats = rig_.said_of<wire::Heartbeat>().size();
    rig_.can().add_fault({.kind = sim::CanFaultKind::disturb, .count = 32});
    rig_.run_for(5 * kSecond);
    EXPECT_EQ(rig_.node().counts().bus_off, 1U);
    EXPECT_GE(rig_.said_of<wire::Heartbeat>().size(), beats + 40);
    EXPECT_EQ(rig_.said().size() - said, rig_.said_of<wire::Heartbeat>().size() - beats);
}

TEST_F(ReliabilityFirmwareTest, F6_a_retry_that_fails_doubles_the_time_up_to_an_hour) {
    drive_into_safe_mode();
    for (const std::int64_t wait_s : {60, 120, 240, 480, 960, 1'920, 3'600, 3'600}) {
        const std::int64_t since_us = rig_.now().us;
        while (rig_.node().state() == NodeState::safe) rig_.run_for(10 * kSecond);
        EXPECT_NEAR(static_cast<double>(rig_.now().us - since_us) * 1e-6, static_cast<double>(wait_s), 11.0);
        rig_.reset({.cause = ResetCause::watchdog});
        EXPECT_EQ(rig_.node().state(), NodeState::safe);
    }
}

TEST_F(ReliabilityFirmwareTest, F6_a_retry_that_lasts_a_minute_ends_it_for_good) {
    drive_into_safe_mode();
    rig_.run_for(130 * kSecond);
    ASSERT_EQ(rig_.node().state(), NodeState::ranging);
    rig_.reset({.cause = ResetCause::watchdog});
    rig_.run_for(1 * kSecond);
    EXPECT_EQ(heartbeat().state, NodeState::ranging);
}

TEST_F(ReliabilityFirmwareTest, F6_a_command_ends_safe_mode_at_once_and_others_are_refused_or_obeyed) {
    drive_into_safe_mode();
    const std::uint32_t rejected = rig_.node().counts().rx_rejected;
    command(CommandCode::stop);
    command(CommandCode::set_rate);
    command(CommandCode::reinitialise_sensor);
    command(CommandCode::send_black_box);
    command(CommandCode::calibrate_offset);
    command(CommandCode::calibrate_crosstalk);
    rig_.run_for(100 * kMillisecond);
    EXPECT_EQ(rig_.node().counts().rx_rejected, rejected + 6);
    const std::size_t pages = rig_.said_of<wire::NodeInfo>().size();
    command(CommandCode::send_info);
    rig_.run_for(500 * kMillisecond);
    EXPECT_EQ(rig_.said_of<wire::NodeInfo>().size(), pages + 7);
    EXPECT_EQ(heartbeat().state, NodeState::safe);
    command(CommandCode::start);
    rig_.run_for(1 * kSecond);
    EXPECT_EQ(heartbeat().state, NodeState::ranging);
    EXPECT_GT(rig_.readings_of(3).back().end.us, rig_.now().us - 100'000);
}

TEST_F(ReliabilityFirmwareTest, F6_resets_by_command_never_lead_to_safe_mode) {
    for (int i = 0; i < 10; ++i) {
        rig_.run_for(300 * kMillisecond);
        command(CommandCode::reset);
        rig_.run_for(5 * kMillisecond);
        ASSERT_TRUE(rig_.node().is_reset_requested());
        rig_.reset({.cause = ResetCause::software});
        ASSERT_NE(rig_.node().state(), NodeState::safe);
    }
}

// F7
void expect_bad_config(const NodeConfig& config, wire::NodeId speaks_as) {
    SensorSetup unfitted;  // on a bus that is not there nothing is
    unfitted.is_fitted = false;
    const auto rig = std::make_unique<NodeRig>(
        config, std::vector<SensorSetup>(config.sensor_count, unfitted), kWrapsAfter5s);
    rig->run_for(3 * kSecond);
    EXPECT_EQ(rig->said_of<wire::Heartbeat>().size(), 30U);
    for (const wire::Heartbeat& beat : rig->said_of<wire::Heartbeat>()) {
        EXPECT_EQ(beat.state, NodeState::bad_config);
        EXPECT_EQ(beat.node_hash_low, 0) << "a host that knows the hash refuses the node";
    }
    for (const wire::CanFrame& frame : rig->frames()) EXPECT_EQ(wire::node_of(frame.can_id), speaks_as);
    EXPECT_TRUE(rig->xshut_events().empty());
    EXPECT_EQ(rig->bus(0).transfer_count(), 0U);
    rig->send_from_host(Command{.code = CommandCode::start}, speaks_as);
    rig->run_for(1 * kSecond);
    EXPECT_EQ(rig->bus(0).transfer_count(), 0U);
}

TEST(ReliabilityFirmware, F7_a_configuration_for_another_board_makes_no_ranges_and_is_named) {
    NodeConfig config = fleet_config(2, 1);
    config.board_type = 7;
    expect_bad_config(config, kOwnId);
}

TEST(ReliabilityFirmware, F7_a_configuration_that_asks_for_a_bus_too_many_makes_no_ranges_and_is_named) {
    NodeConfig config = fleet_config(2, 1);
    config.sensors[1].bus = kNodeBusesMax;
    expect_bad_config(config, kOwnId);
}

// Every single bit of the block: damaged blocks are refused, and the node without one says so under the id
// of nobody.
TEST(ReliabilityFirmware, F7_a_damaged_configuration_block_is_refused_and_named) {
    std::array<std::uint8_t, kNodeConfigBytesMax> memory{};
    const auto block = encode(fleet_config(2, 1), memory);
    for (std::size_t bit = 0; bit < 8 * block.size(); ++bit) {
        auto damaged = memory;
        damaged.at(bit / 8) = static_cast<std::uint8_t>(damaged.at(bit / 8) ^ (1U << (bit % 8)));
        ASSERT_FALSE(decode_node_config(damaged)) << bit;
    }
    expect_bad_config(without_configuration(), 62);
}

// F8: nobody takes a frame for 10 s, then all are taken again.
TEST_F(ReliabilityFirmwareTest, F8_with_a_full_transmit_queue_the_newest_reading_wins_and_drops_are_counted) {
    rig_.run_for(2 * kSecond);
    const std::uint64_t polls_before = rig_.poll_count();
    rig_.run_for(10 * kSecond);
    const std::uint64_t polls_open = rig_.poll_count() - polls_before;
    const auto accepted = rig_.node().counts().accepted;
    const auto late = rig_.node().counts().late + rig_.node().counts().displaced;
    EXPECT_EQ(late, 0U);
    rig_.block_transmission(true);
    const std::uint64_t polls_blocked_before = rig_.poll_count();
    rig_.run_for(10 * kSecond);
    const std::uint64_t polls_blocked = rig_.poll_count() - polls_blocked_before;
    // 4 sensors at 30 Hz: all but those that wait were dropped, and counted.
    const auto counts = rig_.node().counts();
    EXPECT_GE(counts.accepted - accepted, 4U * 300U);
    EXPECT_LE(rig_.node().waiting(), 4U);
    EXPECT_GE(counts.late + counts.displaced, counts.accepted - accepted - 4U - 4U);
    expect_readings_accounted_for(rig_.node());
    // It looks once a millisecond whether there is room again, and that is all it does more.
    EXPECT_LE(polls_blocked, polls_open + 12'000U);
    rig_.block_transmission(false);
    const std::int64_t open_us = rig_.now().us;
    rig_.run_for(1 * kSecond);
    for (std::uint8_t sensor = 0; sensor < 4; ++sensor) {
        const auto readings = rig_.readings_of(sensor);
        const auto first =
            std::ranges::find_if(readings, [&](const SaidReading& said) { return said.end.us > open_us; });
        ASSERT_NE(first, readings.end());
        const TrueRange& truth = *std::ranges::find_if(
            rig_.truth(sensor).rbegin(), rig_.truth(sensor).rend(), [&](const TrueRange& range) {
                return range.range_mm == first->reading.range_mm && range.window_middle < first->end;
            });
        EXPECT_GT(truth.window_middle.us, open_us - 50'000 - 33'000) << "nothing old goes out first";
        expect_only_the_truth(rig_, sensor);
    }
    EXPECT_EQ(last_page<wire::InfoTraffic>(rig_)->late_dropped, counts.late);
}

// F8 as a real controller has it: it takes frames, and takes them back when nobody acknowledged.
TEST_F(ReliabilityFirmwareTest, F8_what_nobody_acknowledges_is_counted_reading_by_reading) {
    rig_.run_for(2 * kSecond);
    const std::uint32_t sent_before = rig_.node().readings_sent();
    const std::uint64_t polls_before = rig_.poll_count();
    rig_.leave_unacknowledged(true);
    rig_.run_for(10 * kSecond);
    const auto counts = rig_.node().counts();
    // Three frames of at most four readings go into the controller every 20 ms: most readings go that way.
    EXPECT_GE(counts.given_up, 300U);
    EXPECT_GE(counts.others_given_up, 50U);
    EXPECT_LE(rig_.node().readings_sent() - sent_before, 12U) << "what the controller holds now";
    expect_readings_accounted_for(rig_.node());
    EXPECT_LE(rig_.poll_count() - polls_before, 40'000U);

    rig_.leave_unacknowledged(false);
    rig_.run_for(2 * kSecond);
    expect_readings_accounted_for(rig_.node());
    const auto after = rig_.node().counts();
    EXPECT_EQ(last_page<wire::InfoTraffic>(rig_)->tx_dropped,
              after.displaced + after.given_up + after.others_given_up);
    std::size_t heard = 0;
    for (std::uint8_t sensor = 0; sensor < 4; ++sensor) heard += rig_.readings_of(sensor).size();
    EXPECT_NEAR(static_cast<double>(heard), static_cast<double>(rig_.node().readings_sent()), 12.0)
        << "sent is what was heard, but for what is on its way";
}

// Found by the campaign: what is due and cannot be sent is looked at once a millisecond, not all the time.
TEST_F(ReliabilityFirmwareTest, F8_a_black_box_that_nobody_takes_does_not_keep_the_loop_busy) {
    rig_.run_for(2 * kSecond);
    command(CommandCode::send_black_box);
    rig_.run_for(100 * kMillisecond);
    ASSERT_FALSE(rig_.said_of<wire::BlackBox>().empty());
    const std::uint64_t polls = rig_.poll_count();
    rig_.block_transmission(true);
    rig_.run_for(1 * kSecond);
    EXPECT_LE(rig_.poll_count() - polls, 4'000U);
}

}  // namespace
}  // namespace octoskin::test
