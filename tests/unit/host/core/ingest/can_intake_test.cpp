// What only the gates together show: a node's life, and joints of a node that is refused. Every single
// rejection is provoked in tests/unit/host/core/pipeline.
#include "host/core/ingest/can_intake.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "common/range_status.hpp"
#include "common/wire/codec.hpp"
#include "common/wire/crc.hpp"
#include "tests/support/bus/scripted_bus.hpp"

namespace octoskin {
namespace {

using test::ScriptedBus;

constexpr wire::NodeId kNode = 3;
constexpr wire::NodeId kJointNode = 9;

HostRig rig() {
    HostRig rig;
    rig.nodes.push_back({.node_id = kNode,
                         .name = "n",
                         .node_hash = 0x12345678,
                         .pinned_build_id = {},
                         .sensors = {HostSensor{}}});
    rig.joint_sources = {{.node_id = kJointNode, .joints = {"a"}, .rate_hz = 100.0}};
    return rig;
}

/// Exchanges at 0.1, 1.1, ..., heartbeats at 10 Hz but for [quiet_from, quiet_to), readings at 30 Hz from 2 s
/// on.
ScriptedBus bus(double quiet_from_s = 99.0, double quiet_to_s = 99.0) {
    ScriptedBus bus;
    bus.set_clock(kNode, 0xFFFF0000U, 50e-6);
    bus.info(0.01, rig().nodes[0]);
    for (int k = 0; k < 8; ++k) {
        bus.health(0.5 + k, kNode, 0);
        bus.exchange(0.1 + k, {kNode, kJointNode});
    }
    for (int k = 0; k < 80; ++k) {
        const double t = k / 10.0;
        if (t < quiet_from_s || t >= quiet_to_s) {
            bus.heartbeat(t, rig().nodes[0]);
        }
    }
    for (double t = 2.0; t < 8.0; t += 0.033) {
        bus.range(t, kNode,
                  {.sensor = 0,
                   .zone = 0,
                   .device_status = kDeviceStatusComplete,
                   .sequence = 0,
                   .range_mm = 1000,
                   .sigma_quarter_mm = 20,
                   .capture = {}});
    }
    return bus;
}

using Visit = std::function<void(const FrameOutcome&, HostTime now)>;
CanIntake take(const ScriptedBus& bus, const Visit& visit, const HostRig& of_rig = rig()) {
    CanIntake intake(of_rig);
    for (const StampedFrame& entry : bus.frames()) {
        const FrameOutcome outcome = intake.on_frame(entry.frame, entry.stamp);
        visit(outcome, intake.now().value_or(HostTime{0}));
    }
    return intake;
}

/// How many readings had this reason, and when the last of them came.
struct Seen {
    int count = 0;
    HostTime last;
};
Seen readings_with(const ScriptedBus& bus, ReadingReason reason) {
    Seen seen;
    (void)take(bus, [&](const FrameOutcome& outcome, HostTime now) {
        for (const auto& reading : outcome.readings) {
            if (!reading && reading.error() == reason) {
                ++seen.count;
                seen.last = now;
            }
        }
    });
    return seen;
}

TEST(CanIntake, accepts_all_readings_of_a_node_that_is_well_and_counts_no_gap) {
    int accepted = 0;
    const CanIntake intake = take(bus(), [&](const FrameOutcome& outcome, HostTime) {
        EXPECT_FALSE(outcome.rejected.has_value());
        for (const auto& reading : outcome.readings) {
            accepted += reading ? 1 : 0;
        }
    });
    EXPECT_EQ(accepted, 182);
    EXPECT_EQ(intake.ranges().record(kNode, 0).sequence.gaps(), 0U);
    EXPECT_EQ(intake.ranges().record(kNode, 0).received, 182U);
    EXPECT_EQ(intake.ranges().record(kNode, 0).device_status[9], 182U);
}

/// An answer to the SYNC of second `k`, by a clock that is so far ahead of the node's.
void answer_as(ScriptedBus& bus, wire::NodeId node, int k, double ahead_s, double delay_s) {
    const double at_s = 0.1 + k;
    bus.send(at_s + delay_s,
             wire::SyncReport{static_cast<std::uint8_t>(k), bus.node_time(node, at_s + ahead_s)}, node);
}

TEST(CanIntake, keeps_the_clock_of_a_node_under_whose_id_another_answers_sync) {
    for (const double ahead_s : {-0.09, -0.03, 0.002, 0.03, 0.06, 0.09}) {
        for (const double delay_s : {0.0005, 0.0015, 0.0025, 0.04}) {  // before and after both true frames
            SCOPED_TRACE(std::to_string(ahead_s) + " s ahead, after " + std::to_string(delay_s) + " s");
            ScriptedBus attacked = bus();
            for (int k = 3; k < 8; ++k) answer_as(attacked, kNode, k, ahead_s, delay_s);
            std::vector<HostTime> captured;
            int contradicted = 0;
            const CanIntake intake = take(attacked, [&](const FrameOutcome& outcome, HostTime) {
                contradicted += outcome.rejected == FrameReason::sync_contradicted ? 1 : 0;
                for (const auto& reading : outcome.readings)
                    if (reading) captured.push_back(reading->captured);
            });
            EXPECT_EQ(contradicted, 5);
            EXPECT_GE(captured.size(), 172U) << "of 182, and two of each second that is attacked";
            for (const HostTime at : captured) {
                const double periods = 1e-9 * static_cast<double>((at - test::host_at(2.0)).count()) / 0.033;
                EXPECT_NEAR(periods, std::round(periods), 0.02) << "a time at which it did not range";
            }
            EXPECT_EQ(intake.clock(kNode).relocks(), 0U);
            EXPECT_EQ(intake.answers(kNode).contradictions(), 5U);
            EXPECT_TRUE(intake.answers(kNode).hears_two(*intake.now()));
            EXPECT_FALSE(intake.answers(kJointNode).hears_two(*intake.now()));
        }
    }
}

TEST(CanIntake, is_not_led_away_by_answers_that_go_further_off_by_little_and_little) {
    for (const double off_s : {0.0003, -0.0003}) {
        ScriptedBus attacked = bus();
        for (int k = 4; k < 8; ++k) answer_as(attacked, kNode, k, off_s * (k - 3), 0.0015);
        int accepted = 0;
        const CanIntake intake = take(attacked, [&](const FrameOutcome& outcome, HostTime) {
            for (const auto& reading : outcome.readings) {
                if (!reading) continue;
                ++accepted;
                const double late_s =
                    1e-9 * static_cast<double>((reading->captured - test::host_at(2.0)).count());
                EXPECT_LT(std::abs(late_s - 0.033 * std::round(late_s / 0.033)), 0.0004);
            }
        });
        EXPECT_GE(accepted, 172);
        EXPECT_EQ(intake.answers(kNode).contradictions(), 1U) << "the last is over 1 ms off";
    }
}

// Each fits a clock that the ones before it have led away; but none that nobody had answered for.
TEST(CanIntake, has_the_rate_of_its_node_after_fifteen_answers_each_a_little_further_off) {
    for (const double off_s : {0.00015, -0.00015}) {
        ScriptedBus attacked = bus();
        for (int k = 8; k < 25; ++k) attacked.exchange(0.1 + k, {kNode, kJointNode});
        for (int k = 80; k < 250; ++k) attacked.heartbeat(k / 10.0, rig().nodes[0]);
        for (int k = 10; k < 25; ++k) answer_as(attacked, kNode, k, off_s * (k - 9), 0.0015);
        const CanIntake intake = take(attacked, [](const FrameOutcome&, HostTime) {});
        EXPECT_NEAR(intake.clock(kNode).drift().value(), -50e-6, 30e-6);
        EXPECT_TRUE(intake.answers(kNode).hears_two(*intake.now()));
    }
}

TEST(CanIntake, uses_no_answer_to_sync_where_none_or_two_of_them_fit) {
    // Before anything is known of the clock; and where it has jumped, and another answers as if it had not.
    for (const bool has_jumped : {false, true}) {
        ScriptedBus attacked = bus();
        if (has_jumped) {
            for (int k = 4; k < 8; ++k) answer_as(attacked, kNode, k, 0.7, 0.0015);
            for (int k = 4; k < 8; ++k) answer_as(attacked, kNode, k, 0.4, 0.0018);
        } else {
            for (int k = 0; k < 8; ++k) answer_as(attacked, kNode, k, 0.05, 0.0015);
        }
        int accepted = 0;
        const CanIntake intake = take(attacked, [&](const FrameOutcome& outcome, HostTime now) {
            for (const auto& reading : outcome.readings) accepted += reading && now.ns > 0 ? 1 : 0;
        });
        EXPECT_EQ(intake.clock(kNode).relocks(), 0U);
        if (!has_jumped) {
            EXPECT_EQ(accepted, 0);
        }
        EXPECT_TRUE(intake.answers(kNode).hears_two(*intake.now()));
    }
}

TEST(CanIntake, does_not_take_the_repeated_answer_to_a_repeated_sync_for_another_sender) {
    ScriptedBus repeated = bus();
    for (int k = 1; k < 8; ++k) answer_as(repeated, kNode, k, 0.0003, 0.0022);
    int accepted = 0;
    int again = 0;
    const CanIntake intake = take(repeated, [&](const FrameOutcome& outcome, HostTime) {
        again += outcome.rejected == FrameReason::sync_repeated ? 1 : 0;
        for (const auto& reading : outcome.readings) accepted += reading ? 1 : 0;
    });
    EXPECT_EQ(again, 7);
    EXPECT_EQ(accepted, 182);
    EXPECT_EQ(intake.answers(kNode).contradictions(), 0U);
    EXPECT_FALSE(intake.answers(kNode).hears_two(*intake.now()));
}

TEST(CanIntake, takes_no_clock_of_before_its_start_for_a_node_that_began_anew) {
    ScriptedBus restarted = bus();
    wire::Heartbeat starting{};
    starting.state = wire::NodeState::starting;
    for (const StampedFrame& entry : restarted.frames()) {
        const auto decoded = wire::decode(entry.frame);
        const auto* beat = decoded ? std::get_if<wire::Heartbeat>(&decoded->message) : nullptr;
        if (beat == nullptr || decoded->node_id != kNode) continue;
        starting = *beat;
        starting.state = wire::NodeState::starting;
    }
    restarted.send(5.1025, starting, kNode);  // between the answer to a SYNC and its contradiction
    answer_as(restarted, kNode, 5, 0.05, 0.0030);
    const CanIntake intake = take(restarted, [](const FrameOutcome&, HostTime) {});
    EXPECT_EQ(intake.clock(kNode).relocks(), 0U);
    EXPECT_FALSE(intake.clock(kNode).fault(*intake.now()).has_value()) << "two exchanges since";
}

TEST(CanIntake, rejects_readings_while_the_clock_map_is_less_certain_than_the_rig_asks) {
    // The node tells 192 us. Of the map: 100 us for each exchange, more so where two of them are drawn out by
    // a second, and less with every further one.
    HostRig strict = rig();
    strict.range_limits.time_uncertainty_max = Microseconds{192 + 250};
    int accepted = 0;
    int uncertain = 0;
    HostTime uncertain_last;
    (void)take(
        bus(),
        [&](const FrameOutcome& outcome, HostTime now) {
            for (const auto& reading : outcome.readings) {
                accepted += reading ? 1 : 0;
                if (!reading && reading.error() == ReadingReason::time_uncertain) {
                    ++uncertain;
                    uncertain_last = now;
                }
            }
        },
        strict);
    EXPECT_EQ(accepted + uncertain, 182);
    EXPECT_GT(uncertain, 5);
    EXPECT_LT(uncertain_last.ns, 5'000'000'000);
}

TEST(CanIntake, trusts_the_clock_of_a_node_that_restarted_only_after_two_more_exchanges) {
    ScriptedBus restarted = bus();
    wire::Heartbeat starting{};
    starting.uid_crc = crc16(ScriptedBus::uid_of(kNode));
    starting.node_hash_low = 0x5678;
    restarted.send(4.05, starting, kNode);
    restarted.info(4.06, rig().nodes[0]);
    // The exchanges of 4.1 and 5.1 s; the second counts from 0.2 s after it.
    const Seen seen = readings_with(restarted, ReadingReason::clock_not_ready);
    EXPECT_NEAR(seen.count, (5.3 - 4.06) / 0.033, 2.0);
    EXPECT_NEAR(static_cast<double>(seen.last.ns) * 1e-9, 5.3, 0.04);
}

TEST(CanIntake, rejects_readings_while_the_heartbeat_is_missing_and_no_longer) {
    const Seen seen = readings_with(bus(4.0, 5.0), ReadingReason::node_lost);
    // Last heard at 3.9 s, so lost from 4.25 s on.
    EXPECT_NEAR(seen.count, (5.0 - 4.25) / 0.033, 2.0);
    EXPECT_LT(seen.last.ns, 5'020'000'000);
}

TEST(CanIntake, calls_no_node_lost_that_it_heard_while_the_time_was_in_doubt) {
    for (const double step_s : {3600.0, -3600.0}) {
        CanIntake intake(rig());
        for (StampedFrame entry : bus().frames()) {
            if (entry.stamp >= test::wall_at(4.55)) entry.stamp.ns += std::llround(1e9 * step_s);
            for (const auto& reading : intake.on_frame(entry.frame, entry.stamp).readings)
                EXPECT_NE(reading ? std::nullopt : std::optional(reading.error()), ReadingReason::node_lost);
        }
        EXPECT_EQ(intake.host_clock().relocks(), 1U);
    }
}

TEST(CanIntake, tells_who_is_lost_where_nobody_ever_sends_sync) {
    CanIntake intake(rig());
    std::optional<WallTime> lost_from;
    std::optional<WallTime> lost_to;
    for (const StampedFrame& entry : bus(4.0, 5.0).frames()) {
        if (wire::node_of(entry.frame.can_id) == wire::kHostId) continue;
        (void)intake.on_frame(entry.frame, entry.stamp);
        ASSERT_EQ(intake.now(), std::nullopt);
        if (intake.nodes().verdict(kNode, std::nullopt) != NodeCondition::lost) continue;
        lost_from = lost_from.value_or(entry.stamp);
        lost_to = entry.stamp;
    }
    ASSERT_TRUE(lost_from);
    EXPECT_NEAR(static_cast<double>(lost_from->ns - test::wall_at(4.25).ns), 0.0, 0.034e9);
    EXPECT_NEAR(static_cast<double>(lost_to->ns - test::wall_at(5.0).ns), 0.0, 0.034e9);
}

TEST(CanIntake, counts_readings_it_could_not_use_as_received_and_not_as_gaps) {
    const CanIntake intake = take(bus(4.0, 5.0), [](const FrameOutcome&, HostTime) {});
    EXPECT_EQ(intake.ranges().record(kNode, 0).received, 182U);
    EXPECT_EQ(intake.ranges().record(kNode, 0).sequence.gaps(), 0U);
}

TEST(CanIntake, takes_no_joints_from_a_node_that_two_boards_share) {
    ScriptedBus shared = bus();
    wire::Heartbeat board{};
    board.uid_crc = 1;
    shared.send(3.0, board, kJointNode);
    board.uid_crc = 2;
    shared.send(3.1, board, kJointNode);
    const double position = 0.0;
    for (double t = 2.5; t < 3.5; t += 0.01) {
        shared.joints(t, kJointNode, {&position, 1});
    }
    int refused = 0;
    int samples = 0;
    (void)take(shared, [&](const FrameOutcome& outcome, HostTime) {
        refused += outcome.rejected == FrameReason::node_refused ? 1 : 0;
        samples += static_cast<int>(std::ranges::count_if(
            outcome.joint_samples, [](const auto& sample) { return sample.has_value(); }));
    });
    EXPECT_NEAR(samples, 60 - 5, 1);  // the first five only tell the pace
    EXPECT_NEAR(refused, 4 * 40, 4);
}

/// The first frame of a sample is lost, the others were held up, and so come shortly before the first frame
/// of the eighth sample after it, which has its number: all between, and the rest of that, is lost.
TEST(CanIntake, takes_no_joints_of_which_one_frame_is_the_next_round_s) {
    for (const double rate_hz : {100.0, 200.0}) {
        HostRig quick = rig();
        quick.joint_sources.at(0).rate_hz = rate_hz;
        ScriptedBus burst = bus();
        const double period_s = 1.0 / rate_hz;
        const double before = 0.0;
        for (int i = 0; i < 80; ++i) burst.joints(2.5 + i * period_s, kJointNode, {&before, 1});
        const double sampled_s = 2.5 + 80 * period_s;
        const double next_round_s = sampled_s + 8 * period_s;
        const auto held_up_s = next_round_s - 2 * period_s;  // less than half a round before the next one's
        for (std::uint8_t index = 1; index < 3; ++index)
            burst.send(held_up_s + 1e-4 * index, wire::JointState{wire::JointPair{index, 0, {}}}, kJointNode);
        const auto time = wire::fd_residue(burst.node_time(kJointNode, sampled_s));
        burst.send(held_up_s + 3e-4, wire::JointState{wire::JointLast{0, 0, time}}, kJointNode);
        burst.send(next_round_s + 1e-4, wire::JointState{wire::JointPair{0, 0, {500'000, 0}}}, kJointNode);
        int taken = 0;
        std::vector<JointReason> refused;
        const auto visit = [&](const FrameOutcome& outcome, HostTime) {
            for (const auto& sample : outcome.joint_samples) {
                taken += sample ? 1 : 0;
                EXPECT_EQ(sample ? sample->position_rad[0] : 0.0, 0.0) << rate_hz;
                if (!sample && sample.error() != JointReason::too_frequent) refused.push_back(sample.error());
            }
        };
        (void)take(burst, visit, quick);
        EXPECT_EQ(taken, 80 - 5) << rate_hz;
        EXPECT_EQ(refused, std::vector{JointReason::contradictory}) << rate_hz;
    }
}

TEST(CanIntake, takes_no_joints_of_a_source_twice_as_quick_as_the_rig_says) {
    for (const double rate_hz : {100.0, 150.0, 200.0, 1000.0}) {
        ScriptedBus quick = bus();
        const double position = 0.0;
        for (int i = 0; i < 100; ++i) quick.joints(2.5 + i / rate_hz, kJointNode, {&position, 1});
        std::map<JointReason, int> rejected;
        int taken = 0;
        (void)take(quick, [&](const FrameOutcome& outcome, HostTime) {
            for (const auto& sample : outcome.joint_samples) {
                taken += sample ? 1 : 0;
                if (!sample) ++rejected[sample.error()];
            }
        });
        const bool is_refused = rate_hz > 160.0;
        const int too_frequent = rejected[JointReason::too_frequent];
        if (is_refused) {
            EXPECT_GE(too_frequent, 90) << rate_hz;
        } else {
            EXPECT_EQ(too_frequent, 5) << rate_hz;
        }
        EXPECT_EQ(taken, is_refused ? 0 : 95) << rate_hz;
    }
}

TEST(CanIntake, takes_no_sample_with_a_position_beyond_the_joints_of_its_source) {
    for (std::size_t beyond = 1; beyond < wire::kJointsPerSample; ++beyond) {
        ScriptedBus other_arm = bus();
        std::array<double, wire::kJointsPerSample> position{0.5};
        for (int i = 0; i < 20; ++i) {
            position.at(beyond) = i < 10 ? 0.0 : -1e-6;
            other_arm.joints(2.5 + 0.01 * i, kJointNode, position);
        }
        std::map<JointReason, int> rejected;
        int taken = 0;
        (void)take(other_arm, [&](const FrameOutcome& outcome, HostTime) {
            for (const auto& sample : outcome.joint_samples) {
                taken += sample ? 1 : 0;
                if (!sample) ++rejected[sample.error()];
            }
        });
        EXPECT_EQ(taken, 5) << beyond;
        EXPECT_EQ(rejected, (std::map<JointReason, int>{{JointReason::too_frequent, 5},
                                                        {JointReason::wrong_count, 10}}))
            << beyond;
    }
}

}  // namespace
}  // namespace octoskin
