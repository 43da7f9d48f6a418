// What the node does on what it hears.
#include <gtest/gtest.h>

#include <algorithm>
#include <variant>

#include "common/wire/names.hpp"

#include "tests/support/idle_ports.hpp"
#include "tests/support/node_rig.hpp"

namespace octoskin::node {
namespace {

using test::fleet_config;
using test::NodeRig;
using test::SensorSetup;
using wire::Command;
using wire::CommandCode;
using wire::NodeState;
using wire::SensorState;

constexpr Microseconds kMillisecond{1'000};
constexpr wire::NodeId kOwnId = 5;

class NodeCommandsTest : public testing::Test {
  protected:
    NodeCommandsTest() : rig_(fleet_config(4, 2), std::vector<SensorSetup>(4)) {
        rig_.run_for(1'500 * kMillisecond);
    }
    void command(CommandCode code, std::uint8_t sensor = wire::kAllSensors, std::uint16_t argument = 0,
                 wire::NodeId id = kOwnId) {
        rig_.send_from_host(
            Command{.code = code, .sensor = sensor, .argument = argument, .sequence = sequence_++}, id);
    }
    std::size_t readings_in(std::uint8_t sensor, Microseconds duration) {
        const std::size_t before = rig_.readings_of(sensor).size();
        rig_.run_for(duration);
        return rig_.readings_of(sensor).size() - before;
    }
    wire::Heartbeat heartbeat() { return rig_.said_of<wire::Heartbeat>().back(); }

    NodeRig rig_;
    std::uint8_t sequence_ = 0;
};

TEST_F(NodeCommandsTest, answers_sync_with_its_own_clock_at_the_end_of_the_frame) {
    rig_.send_from_host(wire::Sync{.sequence = 17}, wire::kHostId);
    rig_.run_for(5 * kMillisecond);
    const auto ends = rig_.times_of<wire::Sync>();
    const auto reports = rig_.said_of<wire::SyncReport>();
    ASSERT_EQ(ends.size(), 1U);
    ASSERT_EQ(reports.size(), 1U);
    EXPECT_EQ(reports[0].sequence, 17);
    EXPECT_EQ(reports[0].heard, rig_.clock().to_node(ends[0]));
}

TEST_F(NodeCommandsTest, stops_and_starts_all_sensors) {
    command(CommandCode::stop);
    // The range under way ends by itself, up to a budget later: only then is the sensor at rest.
    rig_.run_for(20 * kMillisecond);
    EXPECT_EQ(rig_.last_health(3)->state, SensorState::ranging);
    rig_.run_for(180 * kMillisecond);
    EXPECT_EQ(heartbeat().state, NodeState::stopped);
    EXPECT_EQ(heartbeat().degraded_sensors, 0);
    EXPECT_EQ(rig_.last_health(3)->state, SensorState::stopped);
    EXPECT_EQ(readings_in(0, 500 * kMillisecond), 0U);
    const std::size_t truth = rig_.truth(0).size();
    rig_.run_for(500 * kMillisecond);
    EXPECT_EQ(rig_.truth(0).size(), truth) << "the sensor itself must have stopped";

    command(CommandCode::start);
    rig_.run_for(10 * kMillisecond);
    EXPECT_EQ(rig_.last_health(3)->state, SensorState::starting);
    rig_.run_for(190 * kMillisecond);
    EXPECT_EQ(heartbeat().state, NodeState::ranging);
    EXPECT_GE(readings_in(0, 500 * kMillisecond), 14U);
}

// A part follows its temperature only while it ranges. Nothing failed, and nothing is amiss meanwhile.
TEST_F(NodeCommandsTest, brings_sensors_up_anew_that_have_rested_for_more_than_a_minute) {
    command(CommandCode::stop);
    rig_.run_for(62'000 * kMillisecond);
    const std::size_t events = rig_.xshut_events().size();
    command(CommandCode::start);
    rig_.run_for(10 * kMillisecond);
    EXPECT_EQ(rig_.last_health(3)->state, SensorState::starting);
    const std::size_t beats = rig_.said_of<wire::Heartbeat>().size();
    rig_.run_for(500 * kMillisecond);
    EXPECT_EQ(rig_.xshut_events().size(), events + 2U * 4U);
    const auto heartbeats = rig_.said_of<wire::Heartbeat>();
    for (std::size_t i = beats; i < heartbeats.size(); ++i) EXPECT_EQ(heartbeats[i].degraded_sensors, 0);
    EXPECT_EQ(heartbeats.back().state, NodeState::ranging);
    EXPECT_GE(readings_in(2, 300 * kMillisecond), 8U);
    EXPECT_EQ(rig_.node().counts().sensor_restarts, 0U);
}

TEST_F(NodeCommandsTest, stops_a_single_sensor) {
    command(CommandCode::stop, 2);
    rig_.run_for(200 * kMillisecond);
    EXPECT_EQ(rig_.last_health(2)->state, SensorState::stopped);
    EXPECT_EQ(heartbeat().state, NodeState::ranging);
    EXPECT_EQ(readings_in(2, 300 * kMillisecond), 0U);
    EXPECT_GE(readings_in(1, 300 * kMillisecond), 8U);
}

// A frozen sensor fails 80 ms later: whenever the order comes, before, during or after the restart.
TEST(NodeCommands, stops_a_sensor_that_fails_and_would_be_restarted) {
    for (int us = 78'000; us < 85'000; us += 100) {
        NodeRig rig(fleet_config(2, 1), std::vector<SensorSetup>(2));
        rig.run_for(1'000 * kMillisecond);
        rig.sensor(1).set_faults({.freezes_stream = true});
        rig.run_for(Microseconds{us});
        rig.send_from_host(Command{.code = CommandCode::stop}, kOwnId);
        rig.run_for(5 * kMillisecond);
        rig.sensor(1).set_faults({});
        rig.run_for(600 * kMillisecond);
        const std::size_t ranges = rig.truth(1).size();
        rig.run_for(300 * kMillisecond);
        EXPECT_EQ(rig.truth(1).size(), ranges) << us;
        EXPECT_EQ(rig.last_health(1)->state, SensorState::stopped) << us;
    }
}

TEST_F(NodeCommandsTest, obeys_commands_to_all_nodes_and_ignores_those_to_others) {
    command(CommandCode::stop, wire::kAllSensors, 0, 6);
    rig_.run_for(200 * kMillisecond);
    EXPECT_EQ(heartbeat().state, NodeState::ranging);
    command(CommandCode::stop, wire::kAllSensors, 0, wire::kBroadcastId);
    rig_.run_for(200 * kMillisecond);
    EXPECT_EQ(heartbeat().state, NodeState::stopped);
}

TEST_F(NodeCommandsTest, ranges_at_a_commanded_rate_and_says_that_it_is_not_the_configured_one) {
    command(CommandCode::set_rate, wire::kAllSensors, 100);
    rig_.run_for(1'500 * kMillisecond);
    EXPECT_TRUE(heartbeat().is_rate_overridden);
    const std::size_t slow = readings_in(1, 2'000 * kMillisecond);
    EXPECT_GE(slow, 19U);
    EXPECT_LE(slow, 21U);

    command(CommandCode::set_rate, wire::kAllSensors, 0);  // back to the configuration's
    rig_.run_for(1'500 * kMillisecond);
    EXPECT_FALSE(heartbeat().is_rate_overridden);
    const std::size_t configured = readings_in(1, 2'000 * kMillisecond);
    EXPECT_GE(configured, 59U);
    EXPECT_LE(configured, 62U);
}

TEST_F(NodeCommandsTest, refuses_and_counts_a_period_too_short_for_the_timing_budget) {
    command(CommandCode::set_rate, wire::kAllSensors, 24);  // budget 20 ms, and 5 ms to spare
    rig_.run_for(300 * kMillisecond);
    EXPECT_FALSE(heartbeat().is_rate_overridden);
    EXPECT_EQ(rig_.node().counts().rx_rejected, 1U);
    command(CommandCode::set_rate, wire::kAllSensors, 25);
    rig_.run_for(300 * kMillisecond);
    EXPECT_TRUE(heartbeat().is_rate_overridden);
    EXPECT_EQ(rig_.node().counts().rx_rejected, 1U);
}

TEST_F(NodeCommandsTest, refuses_and_counts_commands_for_sensors_it_does_not_have) {
    command(CommandCode::stop, 4);
    command(CommandCode::start, 62);
    command(CommandCode::set_rate, 4, 100);
    command(CommandCode::reinitialise_sensor, 4);
    rig_.run_for(100 * kMillisecond);
    EXPECT_EQ(rig_.node().counts().rx_rejected, 4U);
    EXPECT_EQ(heartbeat().state, NodeState::ranging);
}

TEST_F(NodeCommandsTest, reinitialises_one_sensor_and_leaves_its_neighbours_alone) {
    const std::size_t events = rig_.xshut_events().size();
    command(CommandCode::reinitialise_sensor, 2);
    rig_.run_for(500 * kMillisecond);
    ASSERT_EQ(rig_.xshut_events().size(), events + 2);
    for (std::size_t i = events; i < events + 2; ++i) EXPECT_EQ(rig_.xshut_events()[i].line, 2);
    EXPECT_EQ(rig_.last_health(2)->state, SensorState::ranging);
    EXPECT_EQ(rig_.node().counts().sensor_restarts, 1U);
}

TEST_F(NodeCommandsTest, obeys_a_command_once_that_was_heard_twice) {
    const Command reinitialise{.code = CommandCode::reinitialise_sensor, .sensor = 2, .sequence = 9};
    rig_.send_from_host(reinitialise, kOwnId);
    rig_.send_from_host(reinitialise, kOwnId);
    rig_.run_for(499 * kMillisecond);
    rig_.send_from_host(reinitialise, kOwnId);
    rig_.run_for(300 * kMillisecond);
    EXPECT_EQ(rig_.node().counts().sensor_restarts, 1U);
    rig_.send_from_host(reinitialise, kOwnId);  // long enough after: a host that begins anew
    rig_.run_for(300 * kMillisecond);
    EXPECT_EQ(rig_.node().counts().sensor_restarts, 2U);
}

TEST_F(NodeCommandsTest, blinks_for_as_long_as_it_is_told) {
    command(CommandCode::identify, wire::kAllSensors, 2);
    rig_.run_for(1'900 * kMillisecond);
    EXPECT_EQ(rig_.lit(), (std::vector<bool>{true, false, true, false, true, false, true, false}));
    rig_.run_for(2'000 * kMillisecond);
    EXPECT_FALSE(rig_.lit().back());
    EXPECT_LE(rig_.lit().size(), 9U);
}

TEST(NodeWithoutLight, refuses_to_identify_itself_and_sleeps_on) {
    test::NoLines lines;
    test::NoCan can;
    Node node(without_configuration(), {}, {.buses = {}, .xshut = lines, .can = can}, NodeTime{});
    const auto poll_until = [&node](std::uint32_t end_us) {
        for (std::uint32_t us = 0; us < end_us; us += 1'000) node.poll(NodeTime{us});
    };
    poll_until(1'000'000);
    node.on_frame(wire::encode(Command{.code = CommandCode::identify, .argument = 5}, wire::kBroadcastId),
                  NodeTime{1'000'000});
    EXPECT_EQ(node.counts().rx_rejected, 1U);
    node.poll(NodeTime{1'000'000});
    EXPECT_GT(elapsed(NodeTime{1'000'000}, node.wake_time(NodeTime{1'000'000})), Microseconds{500});
}

TEST_F(NodeCommandsTest, passes_a_reset_on_to_the_application) {
    EXPECT_FALSE(rig_.node().is_reset_requested());
    command(CommandCode::reset);
    rig_.run_for(5 * kMillisecond);
    EXPECT_TRUE(rig_.node().is_reset_requested());
}

TEST_F(NodeCommandsTest, repeats_all_it_knows_of_itself_on_request) {
    const std::size_t pages = rig_.said_of<wire::NodeInfo>().size();
    const std::size_t healths = rig_.said_of<wire::SensorHealth>().size();
    command(CommandCode::send_info);
    rig_.run_for(20 * kMillisecond);
    EXPECT_GE(rig_.said_of<wire::NodeInfo>().size(), pages + 7);
    EXPECT_GE(rig_.said_of<wire::SensorHealth>().size(), healths + 4);
}

TEST_F(NodeCommandsTest, in_safe_mode_only_beats_even_after_bus_off_and_is_woken_by_a_start) {
    for (int i = 0; i < 3; ++i) {
        rig_.reset({.cause = wire::ResetCause::watchdog});
        rig_.run_for(500 * kMillisecond);
    }
    ASSERT_EQ(rig_.node().state(), NodeState::safe);
    const std::size_t said = rig_.said().size();
    const std::size_t beats = rig_.said_of<wire::Heartbeat>().size();
    rig_.can().add_fault({.kind = sim::CanFaultKind::disturb, .count = 32});
    rig_.run_for(2'000 * kMillisecond);
    EXPECT_EQ(rig_.node().counts().bus_off, 1U);
    EXPECT_GE(rig_.said_of<wire::Heartbeat>().size(), beats + 15);
    EXPECT_EQ(rig_.said().size() - said, rig_.said_of<wire::Heartbeat>().size() - beats);
    command(CommandCode::start);
    rig_.run_for(600 * kMillisecond);
    EXPECT_EQ(heartbeat().state, NodeState::ranging);
    EXPECT_GE(readings_in(3, 500 * kMillisecond), 14U);
}

TEST_F(NodeCommandsTest, counts_a_damaged_command_and_does_not_obey_it) {
    wire::CanFrame frame = wire::encode(Command{.code = CommandCode::stop}, kOwnId);
    frame.data[1] = static_cast<std::uint8_t>(frame.data[1] ^ 0x10U);
    rig_.send_from_host(frame);
    rig_.run_for(200 * kMillisecond);
    EXPECT_EQ(rig_.node().counts().rx_rejected, 1U);
    EXPECT_EQ(heartbeat().state, NodeState::ranging);
}

TEST_F(NodeCommandsTest, does_not_care_for_foreign_frames) {
    for (const std::uint32_t can_id : {0x000U, 0x03FU, 0x3FFU, 0x4C5U, 0x7FFU}) {
        wire::CanFrame frame;
        frame.can_id = can_id;
        frame.payload_len = 8;
        rig_.send_from_host(frame);
    }
    wire::CanFrame extended = wire::encode(Command{.code = CommandCode::stop}, kOwnId);
    extended.is_extended = true;
    rig_.send_from_host(extended);
    rig_.run_for(200 * kMillisecond);
    wire::CanFrame error = wire::encode(Command{.code = CommandCode::stop}, kOwnId);
    error.is_error = true;
    rig_.node().on_frame(error, rig_.node_now());
    rig_.run_for(200 * kMillisecond);
    EXPECT_EQ(rig_.node().counts().rx_rejected, 0U);
    EXPECT_EQ(heartbeat().state, NodeState::ranging);
}

TEST_F(NodeCommandsTest, of_the_hosts_frames_cares_for_its_sync_alone) {
    wire::CanFrame follow_up = wire::encode(wire::FollowUp{.sequence = 1, .host_time_us = 2}, wire::kHostId);
    follow_up.data[0] = static_cast<std::uint8_t>(follow_up.data[0] ^ 1U);  // damaged, had anybody looked
    rig_.send_from_host(follow_up);
    wire::CanFrame sync = wire::encode(wire::Sync{.sequence = 1}, wire::kHostId);
    sync.can_id += 1;  // a SYNC of somebody who is not the host
    rig_.send_from_host(sync);
    rig_.run_for(50 * kMillisecond);
    EXPECT_EQ(rig_.node().counts().rx_rejected, 0U);
    EXPECT_TRUE(rig_.said_of<wire::SyncReport>().empty());
}

TEST_F(NodeCommandsTest, answers_a_sync_heard_with_full_mailboxes_once_there_is_room) {
    rig_.block_transmission(true);
    rig_.send_from_host(wire::Sync{.sequence = 17}, wire::kHostId);
    rig_.run_for(20 * kMillisecond);
    EXPECT_TRUE(rig_.said_of<wire::SyncReport>().empty());
    rig_.block_transmission(false);
    rig_.run_for(5 * kMillisecond);
    const auto reports = rig_.said_of<wire::SyncReport>();
    ASSERT_EQ(reports.size(), 1U);
    EXPECT_EQ(reports[0].heard, rig_.clock().to_node(rig_.times_of<wire::Sync>()[0]));
}

TEST_F(NodeCommandsTest, refuses_to_calibrate_while_another_node_speaks_under_its_id) {
    rig_.send_from_host(wire::SyncReport{}, kOwnId);
    rig_.run_for(5 * kMillisecond);
    command(CommandCode::calibrate_offset, 1, 140);
    rig_.run_for(5 * kMillisecond);
    EXPECT_EQ(rig_.node().counts().rx_rejected, 1U);
}

TEST_F(NodeCommandsTest, stops_ranging_while_another_node_speaks_under_its_id) {
    for (int i = 0; i < 10; ++i) {
        rig_.send_from_host(wire::Heartbeat{.state = NodeState::ranging, .uid_crc = 1}, kOwnId);
        rig_.run_for(100 * kMillisecond);
    }
    EXPECT_EQ(rig_.node().state(), NodeState::id_conflict);
    EXPECT_EQ(readings_in(0, 1'000 * kMillisecond), 0U);
    EXPECT_EQ(heartbeat().state, NodeState::id_conflict);

    rig_.run_for(5'000 * kMillisecond);  // the other one is gone
    EXPECT_EQ(rig_.node().state(), NodeState::ranging);
    EXPECT_GE(readings_in(0, 1'000 * kMillisecond), 28U);
}

TEST_F(NodeCommandsTest, sends_no_reading_from_the_moment_it_hears_its_own_id) {
    const auto before = [this] {
        std::size_t count = 0;
        for (std::uint8_t sensor = 0; sensor < 4; ++sensor) count += rig_.readings_of(sensor).size();
        return count;
    };
    for (int i = 0; i < 20; ++i) {
        rig_.run_for(6'777 * kMillisecond);  // a conflict lasts 5 s: at another phase each time
        rig_.send_from_host(wire::SyncReport{.sequence = 1, .heard = {}}, kOwnId);
        rig_.run_for(1 * kMillisecond);  // a frame already in its mailbox may still go
        const std::size_t readings = before();
        rig_.run_for(500 * kMillisecond);
        EXPECT_EQ(before(), readings) << i;
    }
    EXPECT_GT(rig_.node().counts().late, 0U);
}

TEST_F(NodeCommandsTest, stays_stopped_by_command_after_an_id_conflict_is_over) {
    command(CommandCode::stop, 1);
    rig_.send_from_host(wire::SyncReport{}, kOwnId);
    rig_.run_for(6'000 * kMillisecond);
    EXPECT_EQ(readings_in(1, 500 * kMillisecond), 0U);
    EXPECT_GE(readings_in(0, 500 * kMillisecond), 14U);
}

// --- a node whose rig has it refuse commands

std::vector<wire::InfoFault> faults_of(const NodeRig& rig) {
    std::vector<wire::InfoFault> faults;
    for (const wire::NodeInfo& page : rig.said_of<wire::NodeInfo>()) {
        if (const auto* fault = std::get_if<wire::InfoFault>(&page)) faults.push_back(*fault);
    }
    return faults;
}

class NodeRefusingCommandsTest : public testing::Test {
  protected:
    NodeRefusingCommandsTest() : rig_(config(), std::vector<SensorSetup>(4)) {
        rig_.run_for(1'500 * kMillisecond);
    }
    static NodeConfig config() {
        NodeConfig config = fleet_config(4, 2);
        config.refuses_commands = true;
        config.sensors[0].reflex_below_mm = 4'000;
        return config;
    }
    NodeRig rig_;
};

TEST_F(NodeRefusingCommandsTest, refuses_each_of_them_and_says_so_within_a_tenth_of_a_second) {
    std::uint8_t sequence = 0;
    for (const auto& named : wire::values_of(CommandCode{})) {
        for (const wire::NodeId id : {kOwnId, wire::kBroadcastId}) {
            const std::uint32_t refused = rig_.node().counts().rx_rejected;
            const sim::SimTime sent = rig_.now();
            rig_.send_from_host(
                Command{.code = named.value, .sensor = 1, .argument = 140, .sequence = sequence++}, id);
            rig_.run_for(100 * kMillisecond);
            EXPECT_EQ(rig_.node().counts().rx_rejected, refused + 1) << named.name;
            const auto& said = rig_.said();
            EXPECT_TRUE(std::ranges::any_of(said, [&](const auto& item) {
                const auto* info = std::get_if<wire::NodeInfo>(&item.message);
                const auto* fault = info != nullptr ? std::get_if<wire::InfoFault>(info) : nullptr;
                return fault != nullptr && item.end >= sent &&
                       *fault == wire::InfoFault{.kind = wire::FaultKind::commands_refused,
                                                 .where = static_cast<std::uint32_t>(named.value)};
            })) << named.name;
            rig_.run_for(2'500 * kMillisecond);  // until it is over
            EXPECT_EQ(faults_of(rig_).back().kind, wire::FaultKind::none) << named.name;
        }
    }
    EXPECT_FALSE(rig_.node().is_reset_requested());
    EXPECT_TRUE(rig_.lit().empty()) << "identify";
    EXPECT_TRUE(rig_.said_of<wire::BlackBox>().empty());
    EXPECT_EQ(rig_.node().counts().sensor_restarts, 0U);
    for (const wire::Calibration& answer : rig_.said_of<wire::Calibration>())
        EXPECT_EQ(answer.outcome, wire::CalibrationOutcome::refused);
    EXPECT_EQ(rig_.said_of<wire::Calibration>().size(), 4U) << "two codes, two ids";
}

TEST_F(NodeRefusingCommandsTest, answers_sync_and_sends_reflex_and_ranges_whatever_is_commanded) {
    const std::size_t before = rig_.readings_of(1).size();
    for (std::uint8_t i = 0; i < 100; ++i) {
        rig_.send_from_host(Command{.code = CommandCode::stop, .sequence = i}, kOwnId);
        rig_.send_from_host(wire::Sync{.sequence = static_cast<std::uint8_t>(i % 32)}, wire::kHostId);
        rig_.run_for(30 * kMillisecond);
    }
    EXPECT_EQ(rig_.said_of<wire::SyncReport>().size(), 100U);
    EXPECT_GE(rig_.readings_of(1).size() - before, 88U);
    EXPECT_FALSE(rig_.said_of<wire::Reflex>().empty());
    // 3 s of the flood, and 4.5 s at one a second.
    EXPECT_LE(faults_of(rig_).size(), 3U * 10 + 8) << "a flood of commands is answered ten times a second";
}

}  // namespace
}  // namespace octoskin::node
