// The rows "CAN" of the reliability goals that a node keeps, and the reflex. Which test shows which row:
// docs/reference/reliability.md.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "firmware/core/frame_budget.hpp"
#include "host/core/ingest/node_traffic.hpp"
#include "tests/sim/reliability/oracles.hpp"

namespace octoskin::test {
namespace {

using sim::CanFaultKind;
using wire::Command;
using wire::CommandCode;
using wire::NodeState;

constexpr wire::NodeId kOwnId = 5;

class ReliabilityCanTest : public testing::Test {
  protected:
    /// The clock wraps while the bus is in trouble, which begins after 2 s.
    ReliabilityCanTest()
        : rig_(fleet_config(4, 2), std::vector<SensorSetup>(4), wraps_after(2'300 * kMillisecond)) {
        rig_.run_for(2 * kSecond);
    }
    /// Every frame of the node is disturbed, as by a short of the lines, from now on for so many attempts.
    void disturb(std::uint32_t attempts) {
        rig_.can().add_fault({.kind = CanFaultKind::disturb, .count = attempts});
    }
    std::size_t readings() const {
        std::size_t count = 0;
        for (std::uint8_t sensor = 0; sensor < 4; ++sensor) count += rig_.readings_of(sensor).size();
        return count;
    }
    /// When something was next said after `us`; -1 if never.
    std::int64_t next_said_us(std::int64_t us) const {
        for (const SaidMessage& item : rig_.said()) {
            if (item.end.us > us) return item.end.us;
        }
        return -1;
    }
    NodeRig rig_;
};

// C8: 32 errors of 8 are bus-off. Each attempt to come back needs 32 more to fail.
TEST_F(ReliabilityCanTest, C8_bus_off_is_left_after_100_ms_and_then_after_twice_as_long_up_to_800_ms) {
    for (const std::int64_t wait_ms : {100, 200, 400, 800, 800}) {
        const std::int64_t begin_us = rig_.now().us;
        const std::uint32_t before = rig_.node().counts().bus_off;
        disturb(32);
        while (rig_.node().counts().bus_off == before) rig_.run_for(kMillisecond);
        const std::int64_t off_us = rig_.now().us;
        EXPECT_LE(off_us - begin_us, 200'000);
        rig_.run_for(wait_ms * kMillisecond - 3 * kMillisecond);
        EXPECT_EQ(next_said_us(off_us), -1) << "not a bit before its time";
        rig_.run_for(10 * kMillisecond);
        EXPECT_GT(next_said_us(off_us), 0) << wait_ms;
        rig_.run_for(90 * kMillisecond);
    }
    EXPECT_EQ(rig_.node().counts().bus_off, 5U);
}

TEST_F(ReliabilityCanTest, C8_after_bus_off_traffic_is_back_within_a_second_newest_first_and_all_is_counted) {
    disturb(32 * 4);                     // three attempts to come back fail too
    rig_.run_for(1'500 * kMillisecond);  // 100 + 200 + 400 + 800 ms
    ASSERT_EQ(rig_.node().counts().bus_off, 4U);
    const std::int64_t gone_us = rig_.now().us - 800'000;
    rig_.run_for(1 * kSecond);
    const std::int64_t back_us = next_said_us(gone_us);
    ASSERT_GT(back_us, 0);
    EXPECT_LE(back_us - gone_us, 1'000'000);
    EXPECT_EQ(rig_.said_of<wire::Heartbeat>().back().state, NodeState::can_fault);
    EXPECT_EQ(last_page<wire::InfoTraffic>(rig_)->bus_off_count, 4);
    expect_readings_accounted_for(rig_.node());
    for (std::uint8_t sensor = 0; sensor < 4; ++sensor) {
        expect_only_the_truth(rig_, sensor);
        const auto all = rig_.readings_of(sensor);
        const auto first =
            std::ranges::find_if(all, [&](const SaidReading& said) { return said.end.us >= back_us; });
        ASSERT_NE(first, all.end());
        const auto& ranges = rig_.truth(sensor);
        const auto truth = std::ranges::find(ranges, first->reading.range_mm, &TrueRange::range_mm);
        EXPECT_GT(truth->window_middle.us, back_us - 100'000) << "no stale frame";
    }
    rig_.run_for(1 * kSecond);
    EXPECT_EQ(rig_.said_of<wire::Heartbeat>().back().state, NodeState::ranging);
}

// Heard as the node goes bus-off: a SYNC answered seconds later could be taken for a later one's answer.
TEST_F(ReliabilityCanTest, C8_a_sync_heard_before_bus_off_is_not_answered_after_it_but_counted) {
    for (const std::uint32_t attempts : {32U, 32U * 4}) {
        const node::NodeCounts before = rig_.node().counts();
        const std::size_t answers = rig_.said_of<wire::SyncReport>().size();
        disturb(attempts);
        while (rig_.node().counts().bus_off == before.bus_off) rig_.run_for(kMillisecond);
        rig_.node().on_frame(wire::encode(wire::Sync{.sequence = 7}, wire::kHostId), rig_.node_now());
        rig_.run_for(4 * kSecond);
        EXPECT_EQ(rig_.said_of<wire::SyncReport>().size(), answers) << attempts;
        const node::NodeCounts after = rig_.node().counts();
        EXPECT_EQ(after.others_late, before.others_late + 1) << attempts;
        EXPECT_EQ(last_page<wire::InfoTraffic>(rig_)->late_dropped, after.late + after.others_late);
        rig_.send_from_host(wire::Sync{.sequence = 8}, wire::kHostId);
        rig_.run_for(50 * kMillisecond);
        ASSERT_EQ(rig_.said_of<wire::SyncReport>().size(), answers + 1) << attempts;
        EXPECT_EQ(rig_.said_of<wire::SyncReport>().back().sequence, 8);
    }
}

TEST_F(ReliabilityCanTest, C8_error_passive_is_told_and_nothing_is_lost) {
    const std::size_t before = rig_.node().counts().late + rig_.node().counts().displaced;
    disturb(20);
    rig_.run_for(110 * kMillisecond);
    EXPECT_EQ(rig_.said_of<wire::Heartbeat>().back().state, NodeState::can_fault);
    EXPECT_EQ(rig_.node().counts().bus_off, 0U);
    rig_.run_for(3 * kSecond);
    EXPECT_EQ(rig_.said_of<wire::Heartbeat>().back().state, NodeState::ranging);
    EXPECT_EQ(rig_.node().counts().late + rig_.node().counts().displaced, before);
}

// C11: the node's half. At 40 phases of its rhythm; from the first foreign frame under its id on not one more
// reading is sent, its heartbeat says why within one beat, and every reading that it gave up is counted.
TEST_F(ReliabilityCanTest, C11_hearing_its_own_id_stops_its_ranges_is_told_and_every_reading_is_counted) {
    for (int i = 0; i < 40; ++i) {
        rig_.run_for(6'000 * kMillisecond + i * Microseconds{2'711});
        ASSERT_EQ(rig_.node().state(), NodeState::ranging);
        rig_.send_from_host(wire::Heartbeat{.state = NodeState::ranging, .uid_crc = 1}, kOwnId);
        rig_.run_for(1 * kMillisecond);  // what its controller already held may still go
        ASSERT_EQ(rig_.node().state(), NodeState::id_conflict);
        const std::size_t sent = readings();
        rig_.run_for(120 * kMillisecond);
        EXPECT_EQ(readings(), sent) << i;
        EXPECT_EQ(rig_.said_of<wire::Heartbeat>().back().state, NodeState::id_conflict) << i;
        expect_readings_accounted_for(rig_.node());
        EXPECT_EQ(rig_.node().waiting(), 0U) << "given up after 50 ms, and counted so";
    }
}

TEST(ReliabilityCan, C11_two_nodes_under_one_id_both_fall_silent_within_two_heartbeats) {
    // Two whole rigs whose buses are tied together frame by frame.
    NodeRig a(fleet_config(2, 1), std::vector<SensorSetup>(2));
    NodeRig b(fleet_config(2, 1), std::vector<SensorSetup>(2), kWrapsAfter5s);
    a.run_for(1 * kSecond);
    b.run_for(1 * kSecond + 37 * kMillisecond);
    std::size_t heard_a = a.frames().size();
    std::size_t heard_b = b.frames().size();
    for (int i = 0; i < 200; ++i) {
        a.run_for(kMillisecond);
        b.run_for(kMillisecond);
        for (; heard_a < a.frames().size(); ++heard_a) b.node().on_frame(a.frames()[heard_a], b.node_now());
        for (; heard_b < b.frames().size(); ++heard_b) a.node().on_frame(b.frames()[heard_b], a.node_now());
    }
    for (NodeRig* rig : {&a, &b}) {
        EXPECT_EQ(rig->node().state(), NodeState::id_conflict);
        EXPECT_EQ(rig->said_of<wire::Heartbeat>().back().state, NodeState::id_conflict);
        expect_readings_accounted_for(rig->node());
    }
}

/// As a rig has it: sensors that range every 33 ms.
HostNode host_node(std::uint8_t sensors) {
    return {.node_id = kOwnId,
            .name = "n",
            .node_hash = 0,
            .pinned_build_id = {},
            .sensors = std::vector<HostSensor>(sensors)};
}

// C12: whatever makes it speak: orders to tell everything every millisecond, sensors that fail and come back,
// black boxes. In no second more than twice what it says by itself; and the host, whose count is its own,
// does not take it for a babbling node, but would if it said one frame in four twice.
TEST(ReliabilityCan, C12_the_token_bucket_holds_a_node_to_twice_its_rate_in_any_second) {
    for (const std::uint8_t sensors : std::array<std::uint8_t, 3>{1, 4, 17}) {
        NodeConfig config = fleet_config(sensors, 4);
        config.uses_can_fd = false;
        NodeRig rig(config, std::vector<SensorSetup>(sensors), kWrapsAfter5s);
        for (int ms = 0; ms < 3'000; ++ms) {
            const std::uint8_t sequence = static_cast<std::uint8_t>(ms);
            rig.send_from_host(
                Command{.code = ms % 2 == 0 ? CommandCode::send_info : CommandCode::send_black_box,
                        .sequence = sequence},
                kOwnId);
            if (ms % 700 == 0) rig.sensor(0).brown_out(rig.now());
            rig.run_for(kMillisecond);
        }
        // By hand: 10 heartbeats, a SYNC report, 7 pages; 31 readings and one health of each sensor.
        const std::size_t nominal = 18U + 32U * sensors;
        std::vector<std::int64_t> own;
        for (const SaidMessage& item : rig.said()) {
            if (!std::holds_alternative<Command>(item.message)) own.push_back(item.end.us);
        }
        std::size_t first = 0;
        std::size_t most = 0;
        for (std::size_t i = 0; i < own.size(); ++i) {
            while (own[i] - own[first] >= 1'000'000) ++first;
            most = std::max(most, i - first + 1);
        }
        // What waits in the controller when a second begins was counted in the one before.
        EXPECT_LE(most, 2 * nominal + 3) << int{sensors};
        EXPECT_GE(most, nominal) << "it was hardly driven";
        NodeTraffic host(host_node(sensors), 0.0);
        NodeTraffic of_a_babbler(host_node(sensors), 0.0);
        unsigned refused = 0;
        for (std::size_t i = 0; i < own.size(); ++i) {
            const HostTime at{own[i] * 1'000};
            EXPECT_TRUE(host.keeps_with_frame(at)) << int{sensors};
            for (std::size_t said = 0; said < (i % 4 == 0 ? 2U : 1U); ++said) {
                refused += of_a_babbler.keeps_with_frame(at) ? 0U : 1U;
            }
        }
        EXPECT_GT(refused, 0U) << int{sensors};
        EXPECT_LE(longest_silence_us(rig, 0), 110'000) << "heartbeats go first";
    }
}

// The reflex. The distances of the rig's two sensors grow by 3 mm a range from 200 mm on, and begin anew
// after 1400.
class ReliabilityReflexTest : public testing::Test {
  protected:
    static NodeConfig config() {
        NodeConfig config = fleet_config(2, 1);
        config.sensors[1].reflex_below_mm = 500;
        return config;
    }
    NodeRig rig_{config(), std::vector<SensorSetup>(2), kWrapsAfter5s};
};

TEST_F(ReliabilityReflexTest, one_frame_an_event_without_any_host_and_within_5_ms_of_the_reading) {
    rig_.run_for(100 * kSecond);  // 3,000 ranges: below the limit from the start, and twice more
    const auto events = rig_.said_of<wire::Reflex>();
    const auto times = rig_.times_of<wire::Reflex>();
    ASSERT_EQ(events.size(), 3U);
    for (std::size_t i = 0; i < events.size(); ++i) {
        EXPECT_EQ(events[i].sensor, 1);
        EXPECT_EQ(events[i].sequence, i);
        EXPECT_LT(events[i].range_mm, 500);
        const TrueRange& truth =
            *std::ranges::find_if(rig_.truth(1).rbegin(), rig_.truth(1).rend(), [&](const TrueRange& range) {
                return range.range_mm == events[i].range_mm && range.window_middle < times[i];
            });
        // Half the budget of 20 ms after the middle of the window the sensor is ready; 1 ms is the poll's.
        const std::int64_t ready_us = truth.window_middle.us + 10'000;
        EXPECT_LE(times[i].us - ready_us, 5'000 + 1'000);
    }
    // The readings themselves come as always.
    EXPECT_GE(rig_.readings_of(1).size(), 2'980U);
}

// It begins in bus-off, and lasts: what is told once the bus is back is how it is then.
TEST(ReliabilityReflex, C8_an_event_in_bus_off_is_told_afterwards_by_a_reading_of_that_time) {
    NodeConfig config = fleet_config(1, 1);
    config.sensors[0].reflex_below_mm = 3'000;
    NodeRig rig(config, std::vector<SensorSetup>(1));
    // Until the distances begin anew, below the limit.
    const auto is_far = [&] { return !rig.truth(0).empty() && rig.truth(0).back().range_mm > 4'360; };
    while (!is_far()) rig.run_for(kMillisecond);
    const std::uint32_t before = rig.node().counts().bus_off;
    const std::size_t reported = rig.said_of<wire::Reflex>().size();
    rig.can().add_fault({.kind = CanFaultKind::disturb, .count = 32 * 4});
    while (is_far()) rig.run_for(kMillisecond);
    ASSERT_GT(rig.node().counts().bus_off, before);
    rig.run_for(3 * kSecond);
    ASSERT_EQ(rig.said_of<wire::Reflex>().size(), reported + 1) << "one frame an event all the same";
    const auto& ranges = rig.truth(0);
    const std::int64_t said_us = rig.times_of<wire::Reflex>().back().us;
    const auto truth = std::find_if(ranges.rbegin(), ranges.rend(), [&](const TrueRange& range) {
        return range.range_mm == rig.said_of<wire::Reflex>().back().range_mm;
    });
    EXPECT_LE(said_us - truth->window_middle.us, 10'000 + 50'000) << "of that time";
    EXPECT_GT(rig.node().counts().others_late, 0U);
}

TEST_F(ReliabilityReflexTest, goes_out_before_everything_else_and_without_a_token) {
    // All tokens are gone, and the mailboxes are full, when the event comes.
    for (int ms = 0; ms < 2'000; ++ms) {
        rig_.send_from_host(
            Command{.code = CommandCode::send_info, .sequence = static_cast<std::uint8_t>(ms)}, kOwnId);
        rig_.run_for(kMillisecond);
    }
    const auto times = rig_.times_of<wire::Reflex>();
    ASSERT_EQ(times.size(), 1U);
    EXPECT_LE(times[0].us, 400'000);  // by the first reading
}

// Two of them, while every mailbox is full: once one falls free both go out, once each and before all that
// waited with them.
TEST(ReliabilityReflex, that_no_mailbox_took_goes_out_first_as_soon_as_one_is_free) {
    NodeConfig config = fleet_config(2, 1);
    for (std::size_t sensor : {0U, 1U}) config.sensors.at(sensor).reflex_below_mm = 3'000;
    NodeRig rig(config, std::vector<SensorSetup>(2));
    rig.run_for(200 * kMillisecond);
    rig.block_transmission(true);
    // The first one of each sensor, without wrap check, is no hit.
    while (rig.node().counts().accepted < 4) rig.run_for(kMillisecond);
    rig.run_for(10 * kMillisecond);
    ASSERT_EQ(rig.said_of<wire::Reflex>().size(), 0U);
    const std::size_t before = rig.said().size();
    rig.block_transmission(false);
    rig.run_for(10 * kMillisecond);
    ASSERT_GE(rig.said().size(), before + 3);
    for (std::size_t i = 0; i < 2; ++i) {
        const auto* event = std::get_if<wire::Reflex>(&rig.said()[before + i].message);
        ASSERT_NE(event, nullptr) << i;
        EXPECT_EQ(event->sensor, i);
        EXPECT_EQ(event->sequence, i);
    }
    EXPECT_EQ(rig.said_of<wire::Reflex>().size(), 2U);
}

}  // namespace
}  // namespace octoskin::test
