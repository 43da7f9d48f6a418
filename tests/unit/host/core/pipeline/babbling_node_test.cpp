// A node that says more than its rig has it say, beside others: it is refused by name, they are not touched,
// and frames that were only held back make nobody a babbler.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/unit/host/core/pipeline/one_joint_scene.hpp"

namespace octoskin::test {
namespace {

/// good_scene, and the right node with a reading every 33 ms from 2.5 to 8.9 s.
Scene scene_of_two() {
    Scene scene = good_scene();
    keep_alive(scene, kRight);
    scene.bus.info(0.05, node_of(scene, kRight), 77);
    for (double t = 2.5; t < 8.9; t += 0.033) {
        scene.bus.range(t, kRight, good_reading());
    }
    return scene;
}

/// From 4 to 5.5 s four times its 50 frames a second, beside those that it sends anyway.
Scene babbling_scene() {
    Scene scene = scene_of_two();
    for (double t = 4.0; t < 5.5; t += 0.005) {
        scene.bus.heartbeat(t, node_of(scene, kRight));
    }
    return scene;
}

/// What the gate says while frames come: when the right node's verdict was `babbling` first and last, and who
/// else ever was.
struct Seen {
    double first_s = 0.0;
    double last_s = 0.0;
    unsigned others = 0;
};
Seen babbling_in(const Scene& scene, const std::vector<StampedFrame>& frames) {
    CanIntake intake(scene.rig);
    Seen seen;
    for (const StampedFrame& entry : frames) {
        (void)intake.on_frame(entry.frame, entry.stamp);
        for (const auto& [node, record] : intake.nodes().records()) {
            if (intake.nodes().verdict(node, intake.now()) != NodeCondition::babbling) continue;
            const double at_s = 1e-9 * static_cast<double>(entry.stamp.ns - kWallOffsetNs);
            seen.others += node == kRight ? 0U : 1U;
            seen.first_s = seen.first_s == 0.0 ? at_s : seen.first_s;
            seen.last_s = at_s;
        }
    }
    return seen;
}

TEST(BabblingNode, is_refused_within_a_second_and_comes_back_two_seconds_after_it_stopped) {
    const Scene scene = babbling_scene();
    const Seen seen = babbling_in(scene, scene.bus.frames());
    EXPECT_GT(seen.first_s, 4.0);
    EXPECT_LT(seen.first_s, 5.0);
    EXPECT_GT(seen.last_s, 6.5) << "a second after its last frame that was too many";
    EXPECT_LT(seen.last_s, 7.5);
    EXPECT_EQ(seen.others, 0U);
}

// The oracle is the same bus without the babble, and without the readings that were refused for it.
TEST(BabblingNode, leaves_the_map_as_if_its_refused_readings_had_never_been_sent) {
    const Scene scene = babbling_scene();
    const Seen seen = babbling_in(scene, scene.bus.frames());
    const Scene quiet = scene_of_two();
    std::vector<StampedFrame> rest;
    for (const StampedFrame& entry : quiet.bus.frames()) {
        const double at_s = 1e-9 * static_cast<double>(entry.stamp.ns - kWallOffsetNs);
        const bool is_refused = entry.frame.can_id == wire::can_id(wire::FrameType::range, kRight) &&
                                at_s >= seen.first_s && at_s <= seen.last_s;
        if (!is_refused) rest.push_back(entry);
    }
    const RunResult expected = run(quiet, rest);
    const RunResult result = run(scene);
    const std::uint64_t refused = result.inputs.readings.rejected(ReadingReason::node_babbling);
    EXPECT_GT(refused, 60U);
    EXPECT_EQ(result.inputs.readings.in(), expected.inputs.readings.in() + refused);
    EXPECT_EQ(result.inputs.readings.used(), expected.inputs.readings.used());
    EXPECT_GT(result.inputs.readings.used(), 80U)
        << "the left node's ten, and the right one's before and after";
    EXPECT_TRUE(result.has_equal_maps(expected));
}

TEST(BabblingNode, is_judged_in_a_replay_as_it_was_live) {
    Scene live = babbling_scene();
    live.config.release = Release::once_placed;
    const RunResult then = run(live);
    const RunResult now = run(babbling_scene());
    EXPECT_GT(now.inputs.readings.rejected(ReadingReason::node_babbling), 60U);
    EXPECT_EQ(now.inputs.readings.rejected(ReadingReason::node_babbling),
              then.inputs.readings.rejected(ReadingReason::node_babbling));
    EXPECT_EQ(now.inputs.frames.rejected(FrameReason::node_refused),
              then.inputs.frames.rejected(FrameReason::node_refused));
}

TEST(BabblingNode, whose_joint_states_come_too_often_gives_no_joint_state) {
    Scene scene = good_scene();
    scene.rig.joint_sources.at(0).rate_hz = 40.0;  // 178 frames a second: a hundred samples are 400
    const RunResult result = run(scene);
    EXPECT_GT(result.inputs.frames.rejected(FrameReason::node_refused), 2'000U);
}

/// What came from `from_s` on for `held_s` comes 50 us apart when that is over, and what came then waits for
/// its turn: as from an adapter that hung. `is_host_on_time`: but for the host's own frames.
std::vector<StampedFrame> held_back(const std::vector<StampedFrame>& frames, double from_s, double held_s,
                                    bool is_host_on_time) {
    const WallTime from = wall_at(from_s);
    const WallTime until = wall_at(from_s + held_s);
    std::vector<StampedFrame> delivered;
    WallTime next = until;
    for (StampedFrame entry : frames) {
        const bool is_of_host = wire::node_of(entry.frame.can_id) == wire::kHostId;
        if (entry.stamp >= from && entry.stamp < next && !(is_host_on_time && is_of_host)) {
            entry.stamp = next;
            next.ns += 50'000;
        }
        delivered.push_back(entry);
    }
    std::ranges::stable_sort(delivered, {}, &StampedFrame::stamp);
    return delivered;
}

// The joint node's 418 frames a second are most: 844 within a second are too many.
TEST(BabblingNode, is_nobody_whose_frames_were_only_held_back) {
    const Scene scene = scene_of_two();
    for (const bool is_host_on_time : {false, true}) {
        for (const int held_ms : {20, 80, 135, 145, 400, 1'100, 1'700, 2'900}) {
            // The exchange of 6.1 s is before, in, or after what was held back.
            for (const int until_ms : {5'400, 6'050, 6'090, 6'098, 6'150}) {
                const auto frames = held_back(scene.bus.frames(), 1e-3 * (until_ms - held_ms), 1e-3 * held_ms,
                                              is_host_on_time);
                const Seen seen = babbling_in(scene, frames);
                EXPECT_EQ(seen.first_s, 0.0) << held_ms << " ms held back until " << until_ms << " ms";
            }
        }
    }
}

}  // namespace
}  // namespace octoskin::test
