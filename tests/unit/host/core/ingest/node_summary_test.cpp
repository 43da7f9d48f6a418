#include "host/core/ingest/node_summary.hpp"

#include <gtest/gtest.h>

#include "common/range_status.hpp"
#include "tests/support/bus/scripted_bus.hpp"

namespace octoskin {
namespace {

constexpr wire::NodeId kNode = 3;

HostRig rig(std::uint32_t hash = 0x12345678) {
    HostRig rig;
    rig.nodes.push_back({.node_id = kNode,
                         .name = "ring",
                         .node_hash = hash,
                         .pinned_build_id = {},
                         .sensors = {HostSensor{}}});
    rig.joint_sources = {{.node_id = 19, .joints = {"a"}, .rate_hz = 100.0}};
    return rig;
}

/// Nine seconds of a node, 80 readings from 1 s on. From 4.5 s on its clock is `jump_us` ahead.
test::ScriptedBus bus(std::uint32_t jump_us = 0) {
    test::ScriptedBus bus;
    bus.info(0.01, rig().nodes[0]);
    for (int k = 0; k < 90; ++k) {
        const double t = 0.1 * k;
        bus.set_clock(kNode, t > 4.5 ? jump_us : 0);
        bus.heartbeat(t, rig().nodes[0]);
        if (k % 10 == 1) {
            bus.exchange(t, {kNode});
            bus.health(t + 0.01, kNode, 0);
        }
        if (k >= 10) {
            bus.range(t, kNode,
                      {.sensor = 0,
                       .zone = 0,
                       .device_status = kDeviceStatusComplete,
                       .sequence = 0,
                       .range_mm = 1000,
                       .sigma_quarter_mm = 20,
                       .capture = {}});
        }
    }
    return bus;
}

/// Leaves out the 50th to 54th reading if told so.
NodeSummary summary_of(const test::ScriptedBus& bus, bool loses_five = false, const HostRig& of = rig()) {
    CanIntake intake(of);
    int readings = 0;
    for (const StampedFrame& entry : bus.frames()) {
        const bool is_range = entry.frame.can_id == wire::can_id(wire::FrameType::range, kNode);
        readings += is_range ? 1 : 0;
        if (!(loses_five && is_range && readings >= 50 && readings < 55)) {
            (void)intake.on_frame(entry.frame, entry.stamp);
        }
    }
    const auto all = summarise(intake);
    EXPECT_EQ(all.size(), 2U) << "and the source of joints";
    EXPECT_FALSE(all.back().readings.has_value());
    return all.front();
}

TEST(NodeSummary, of_a_node_that_is_well_shows_nothing_lost) {
    const NodeSummary well = summary_of(bus());
    EXPECT_EQ(well.name, "ring");
    EXPECT_EQ(well.readings->received, 80U);
    EXPECT_EQ(well.readings->gaps, 0U);
    EXPECT_EQ(well.clock_relocks, 0U);
    EXPECT_EQ(well.verdict, NodeCondition::usable);
    EXPECT_FALSE(well.reason.has_value());
}

TEST(NodeSummary, counts_readings_that_never_came) {
    const NodeSummary lossy = summary_of(bus(), true);
    EXPECT_EQ(lossy.readings->received, 75U);
    EXPECT_EQ(lossy.readings->gaps, 5U);
}

TEST(NodeSummary, counts_a_clock_that_jumped) {
    EXPECT_EQ(summary_of(bus(700'000)).clock_relocks, 1U);
}

TEST(NodeSummary, tells_both_values_where_they_differ) {
    const NodeSummary other = summary_of(bus(), false, rig(0x1234ABCD));
    EXPECT_EQ(other.verdict, NodeCondition::info_mismatch);
    EXPECT_EQ(other.reason->text(), "low half of node_hash 00005678, the rig has 0000abcd");
}

TEST(NodeSummary, keeps_gaps_over_a_restart_of_the_node) {
    test::ScriptedBus restarted = bus();
    wire::Heartbeat starting{};
    starting.uid_crc = 1;
    restarted.send(8.95, starting, kNode);
    EXPECT_EQ(summary_of(restarted, true).readings->gaps, 5U);
}

TEST(NodeSummary, of_a_log_without_sync_says_so) {
    EXPECT_TRUE(summary_of(bus()).has_time);
    test::ScriptedBus silent;
    silent.info(0.01, rig().nodes[0]);
    silent.heartbeat(0.1, rig().nodes[0]);
    const NodeSummary untimed = summary_of(silent);
    EXPECT_EQ(untimed.verdict, NodeCondition::usable);
    EXPECT_FALSE(untimed.has_time);
}

TEST(NodeSummary, is_a_table_of_one_line_a_node) {
    const NodeSummary nodes[] = {{.node_id = 1,
                                  .name = "rear_rings",
                                  .readings = NodeSummary::Readings{.received = 2218, .lost = 12, .gaps = 7},
                                  .clock_relocks = 1,
                                  .verdict = NodeCondition::usable,
                                  .reason = {},
                                  .registers = {}},
                                 {.node_id = 62,
                                  .name = "joints",
                                  .readings = {},
                                  .clock_relocks = 0,
                                  .verdict = NodeCondition::other_version,
                                  .reason = NodeMismatch{"version", 2, 1, "this host uses"},
                                  .registers = {}},
                                 {.node_id = 63,
                                  .name = "untimed",
                                  .readings = {},
                                  .clock_relocks = 0,
                                  .verdict = NodeCondition::usable,
                                  .has_time = false,
                                  .reason = {},
                                  .registers = {}}};
    EXPECT_EQ(to_text(nodes),
              "node                  readings      lost      gaps  re-locks  verdict\n"
              "  1 rear_rings            2218        12         7         1  usable\n"
              " 62 joints                   -         -         -         0  other_version: version 2, this "
              "host uses 1\n"
              " 63 untimed                  -         -         -         0  no SYNC in the log\n");
}

}  // namespace
}  // namespace octoskin
