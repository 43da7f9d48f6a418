// Clocks that step while the robot moves: a measurement is placed where it was taken, or not at all.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "common/wire/codec.hpp"
#include "host/io/mapfile/octomap_writer.hpp"
#include "tests/unit/host/core/pipeline/turning_scene.hpp"

namespace octoskin::test {
namespace {

constexpr double kStep_s = 4.5;  ///< 0.4 s after an exchange

/// The scene up to the step, then the same with the node's clock `step_s` ahead.
std::vector<StampedFrame> frames_with_jump(wire::NodeId node, double step_s) {
    const auto step_us = static_cast<std::uint32_t>(std::llround(1e6 * step_s));
    std::vector<StampedFrame> frames = turning_scene(node).bus.frames();
    const std::vector<StampedFrame> jumped = turning_scene(node, 3'000'000'000U + step_us).bus.frames();
    for (std::size_t i = 0; i < frames.size(); ++i) {
        frames[i] = frames[i].stamp < wall_at(kStep_s) ? frames[i] : jumped[i];
    }
    return frames;
}

TEST(ClockSteps, none_uses_every_reading) {
    const Scene scene = turning_scene();
    const Pipeline pipeline = play(scene, scene.bus.frames());
    EXPECT_EQ(pipeline.inputs().readings.used(), 149U) << pipeline.inputs_text();
    expect_hits_where_shots_ended(pipeline, 60);
}

TEST(ClockSteps, of_the_wall_clock_put_no_range_in_the_wrong_place) {
    const Scene scene = turning_scene();
    for (const double step_s :
         {0.004, 0.01, 0.03, 0.049, 0.051, 0.06, 0.1, 0.14, 0.15, 0.2,    0.24,   0.25, 0.26,
          0.262, 0.27, 0.3,  0.5,   0.53,  1.0,  3.0, 4.9,  5.1,  16.777, 16.778, 60.0, 3600.0}) {
        for (const double sign : {1.0, -1.0}) {
            SCOPED_TRACE("step of " + std::to_string(sign * step_s) + " s");
            std::vector<StampedFrame> frames = scene.bus.frames();
            for (StampedFrame& entry : frames) {
                entry.stamp.ns += entry.stamp >= wall_at(kStep_s) ? std::llround(1e9 * sign * step_s) : 0;
            }
            const Pipeline pipeline = play(scene, frames);
            expect_hits_where_shots_ended(pipeline, 60);
            // The exchanges of 5.1 and 6.1 s agree again.
            EXPECT_GT(pipeline.inputs().readings.used(), 90U) << pipeline.inputs_text();
        }
    }
}

/// The maps, byte by byte.
std::string maps_of(const Pipeline& pipeline) {
    return encode_ot(pipeline.map()) + encode_ot(pipeline.map(MapFeed::ranges));
}

TEST(ClockSteps, of_the_wall_clock_by_an_hour_are_counted_and_over_after_two_exchanges) {
    const Scene scene = turning_scene();
    for (const double step_s : {3600.0, -3600.0}) {
        std::vector<StampedFrame> frames = scene.bus.frames();
        for (StampedFrame& entry : frames) {
            entry.stamp.ns += entry.stamp >= wall_at(kStep_s) ? std::llround(1e9 * step_s) : 0;
        }
        const Pipeline pipeline = play(scene, frames);
        const HostClockEstimate& clock = pipeline.intake().host_clock();
        EXPECT_EQ(clock.steps_back(), step_s < 0.0 ? 1U : 0U);
        EXPECT_EQ(clock.steps_ahead(), step_s > 0.0 ? 1U : 0U);
        EXPECT_EQ(clock.relocks(), 1U);
        // Lost: 48 readings of 4.5 to 6.101 s, and the few around them that wait or have no pose.
        EXPECT_GE(pipeline.inputs().readings.used(), 149U - 48U - 10U) << pipeline.inputs_text();
    }
}

TEST(ClockSteps, of_single_stamps_do_not_change_the_map) {
    const Scene scene = turning_scene();
    const std::vector<StampedFrame> clean = scene.bus.frames();
    const std::string expected = maps_of(play(scene, clean));
    wire::CanFrame foreign;
    foreign.can_id = 0x7A1;
    foreign.payload_len = 1;
    // Frames of our own that say nothing new: a heartbeat, a reading that is there already.
    ScriptedBus bus;
    bus.heartbeat(4.5, node_of(scene, kLeft));
    const wire::CanFrame heartbeat = bus.frames().front().frame;
    const auto is_range = [](const StampedFrame& entry) {
        return entry.frame.can_id == wire::can_id(wire::FrameType::range, kLeft);
    };
    const wire::CanFrame range = std::ranges::find_if(clean, is_range)->frame;
    for (const wire::CanFrame& frame : {foreign, heartbeat, range}) {
        for (const double step_s : {3600.0, 1.0, -0.03, -0.1, -1.0, -3600.0}) {
            for (const double at_s : {3.2, 4.5, 5.1005, 6.0}) {
                SCOPED_TRACE(std::to_string(frame.can_id) + " at " + std::to_string(at_s) + " s, stamped " +
                             std::to_string(step_s) + " s ahead");
                std::vector<StampedFrame> frames = clean;
                const auto place = std::ranges::find_if(
                    frames, [&](const StampedFrame& entry) { return entry.stamp >= wall_at(at_s); });
                frames.insert(place, {wall_at(at_s + step_s), frame});
                EXPECT_TRUE(maps_of(play(scene, frames)) == expected);
            }
        }
    }
}

TEST(ClockSteps, of_one_frame_of_ours_stamped_ahead_cost_what_comes_within_four_stamps) {
    const Scene scene = turning_scene();
    const std::vector<StampedFrame> clean = scene.bus.frames();
    for (const double ahead_s : {0.006, 0.03, 0.1, 0.139, 0.141, 0.3, 0.499, 0.6}) {
        // Of a joint sample, of a range, of a SYNC.
        for (const double at_s : {4.5, 4.500'2, 4.517, 5.1, 5.101}) {
            SCOPED_TRACE(std::to_string(at_s) + " s stamped " + std::to_string(ahead_s) + " s ahead");
            std::vector<StampedFrame> frames = clean;
            const auto wrong = std::ranges::find_if(
                frames, [&](const StampedFrame& entry) { return entry.stamp >= wall_at(at_s); });
            wrong->stamp.ns += std::llround(1e9 * ahead_s);
            const Pipeline pipeline = play(scene, frames);
            expect_hits_where_shots_ended(pipeline, 60);
            EXPECT_GE(pipeline.inputs().readings.used(), 149U - 2U) << pipeline.inputs_text();
            const HostClockEstimate& clock = pipeline.intake().host_clock();
            EXPECT_EQ(clock.steps_back() + clock.steps_ahead() + clock.relocks(), 0U);
        }
    }
}

/// The host that sends SYNC began anew at the step: from then on it tells earlier times.
std::vector<StampedFrame> frames_with_host_back(double back_s) {
    std::vector<StampedFrame> frames = turning_scene().bus.frames();
    for (StampedFrame& entry : frames) {
        const auto decoded = wire::decode(entry.frame);
        const auto* reported = decoded ? std::get_if<wire::FollowUp>(&decoded->message) : nullptr;
        if (reported == nullptr || entry.stamp < wall_at(kStep_s)) {
            continue;
        }
        const auto back_us = static_cast<std::uint64_t>(std::llround(1e6 * back_s));
        entry.frame = wire::encode(wire::FollowUp{reported->sequence, reported->host_time_us - back_us},
                                   decoded->node_id);
    }
    return frames;
}

TEST(ClockSteps, back_of_the_host_that_sends_sync_are_counted_and_over_after_two_exchanges) {
    for (const auto release : {Release::by_capture_time, Release::once_placed}) {
        for (const double back_s : {0.15, 0.3, 1.0, 1.1, 1.2, 1.24, 1.4, 3.0, 4.9}) {
            SCOPED_TRACE("back by " + std::to_string(back_s) + " s");
            Scene scene = turning_scene();
            scene.config.release = release;
            const Pipeline pipeline = play(scene, frames_with_host_back(back_s));
            expect_hits_where_shots_ended(pipeline, 60);
            // A second passes in doubt; up to 0.15 s more are waited for.
            EXPECT_EQ(pipeline.times_back(), back_s > 1.15 ? 1U : 0U);
            // In doubt from 5.101 s, told anew at 6.101 s; the nodes' clocks have settled 0.2 s later.
            EXPECT_GE(pipeline.inputs().readings.used(), 149U - 37U - 12U) << pipeline.inputs_text();
        }
    }
}

/// How old a voxel is that range sensors confirmed last; 9999 if there is none.
std::uint32_t age_of_oldest_s(const FusedMap& map) {
    std::uint32_t oldest_s = 9999;
    map.for_each_known([&](VoxelKey key, float) {
        const auto confirmed = map.confirmation(key);
        if (!confirmed || confirmed->kind != SensorKind::range) return;
        oldest_s = oldest_s == 9999 ? confirmed->age_s : std::max(oldest_s, confirmed->age_s);
    });
    return oldest_s;
}

// Of a new host, to --listen-only: nothing is 700 s older by it, and nothing is forgotten.
TEST(ClockSteps, ahead_of_the_host_that_sends_sync_make_nothing_older) {
    for (const auto release : {Release::by_capture_time, Release::once_placed}) {
        for (const double ahead_s : {0.5, 3.0, 700.0, 1e6}) {
            SCOPED_TRACE("ahead by " + std::to_string(ahead_s) + " s");
            Scene scene = turning_scene();
            scene.config.release = release;
            scene.mapping.map.age = {.stale_after_s = 60, .unknown_after_s = 600};
            const Pipeline pipeline = play(scene, frames_with_host_back(-ahead_s));
            expect_hits_where_shots_ended(pipeline, 60);
            EXPECT_EQ(pipeline.times_ahead(), ahead_s > 1.0 ? 1U : 0U);
            EXPECT_EQ(pipeline.times_back(), 0U);
            // The first shot is of 3.0 s, the newest of 7.9 s.
            EXPECT_NEAR(age_of_oldest_s(pipeline.map()), 5.0, 1.0);
        }
    }
}

/// The scene up to the step, and what follows so much later: nobody spoke meanwhile.
std::vector<StampedFrame> frames_with_silence(double silence_s, double wall_step_s = 0.0) {
    std::vector<StampedFrame> frames = frames_with_host_back(-silence_s);
    for (StampedFrame& entry : frames)
        if (entry.stamp >= wall_at(kStep_s)) entry.stamp.ns += std::llround(1e9 * (silence_s + wall_step_s));
    return frames;
}

TEST(ClockSteps, none_over_a_silence_of_a_quarter_of_an_hour_which_makes_a_map_old) {
    Scene scene = turning_scene();
    scene.mapping.map.age = {.stale_after_s = 60, .unknown_after_s = 0};
    const Pipeline pipeline = play(scene, frames_with_silence(900.0));
    EXPECT_EQ(pipeline.times_ahead(), 0U);
    EXPECT_NEAR(age_of_oldest_s(pipeline.map()), 905.0, 1.0);
}

// A controller that was off for a while: its clock begins anew, and the map has grown old meanwhile.
TEST(ClockSteps, back_after_a_silence_make_a_map_as_old_as_it_is) {
    std::vector<StampedFrame> frames = frames_with_host_back(3.0);
    for (StampedFrame& entry : frames)
        if (entry.stamp >= wall_at(kStep_s)) entry.stamp.ns += 900'000'000'000;
    Scene scene = turning_scene();
    scene.mapping.map.age = {.stale_after_s = 60, .unknown_after_s = 0};
    const Pipeline pipeline = play(scene, frames);
    EXPECT_EQ(pipeline.times_back(), 1U);
    EXPECT_NEAR(age_of_oldest_s(pipeline.map()), 905.0, 1.0);
}

/// As `play`, but from the step on with another pipeline, as a daemon that reads its files anew.
Pipeline play_in_two(const Scene& scene, const std::vector<StampedFrame>& frames) {
    const auto step = std::ranges::find_if(
        frames, [](const StampedFrame& entry) { return entry.stamp >= wall_at(kStep_s); });
    Pipeline first = play(scene, {frames.begin(), step});
    Pipeline second = make_pipeline(scene);
    second.resume_from(first);
    std::vector<StampedFrame> rest;
    for (const StampedFrame& entry : frames) {  // who the nodes are is asked for anew
        const auto decoded = wire::decode(entry.frame);
        if (decoded && std::holds_alternative<wire::NodeInfo>(decoded->message))
            rest.push_back({step->stamp, entry.frame});
    }
    rest.insert(rest.end(), step, frames.end());
    ScriptedSource source(rest);
    EXPECT_TRUE(replay(second, source, {}).is_complete());
    EXPECT_GT(second.inputs().readings.used(), 30U) << second.inputs_text();
    return second;
}

TEST(ClockSteps, that_come_while_a_pipeline_gives_way_to_another_age_the_map_as_they_do_else) {
    Scene scene = turning_scene();
    scene.mapping.map.age = {.stale_after_s = 60, .unknown_after_s = 0};
    const auto age_s = [&](const std::vector<StampedFrame>& frames) {
        return age_of_oldest_s(play_in_two(scene, frames).map());
    };
    EXPECT_NEAR(age_s(turning_scene().bus.frames()), 5.0, 1.0);
    EXPECT_NEAR(age_s(frames_with_silence(900.0)), 905.0, 1.0);
    EXPECT_NEAR(age_s(frames_with_host_back(-700.0)), 5.0, 1.0) << "another host's clock, 700 s ahead";
    std::vector<StampedFrame> anew = frames_with_host_back(3.0);
    for (StampedFrame& entry : anew)
        if (entry.stamp >= wall_at(kStep_s)) entry.stamp.ns += 900'000'000'000;
    EXPECT_NEAR(age_s(anew), 905.0, 1.0) << "the time begins anew after a silence";
}

TEST(ClockSteps, of_a_wall_clock_while_nobody_spoke_make_nothing_older_than_it_is) {
    Scene scene = turning_scene();
    scene.mapping.map.age = {.stale_after_s = 60, .unknown_after_s = 0};
    const Pipeline ahead = play(scene, frames_with_silence(900.0, 3600.0));
    EXPECT_EQ(ahead.times_ahead(), 0U);
    EXPECT_NEAR(age_of_oldest_s(ahead.map()), 905.0, 1.0);
    // Which of the two clocks was set nobody can tell: the lesser counts.
    const Pipeline back = play(scene, frames_with_silence(900.0, -300.0));
    EXPECT_EQ(back.times_ahead(), 1U);
    EXPECT_NEAR(age_of_oldest_s(back.map()), 605.0, 1.0);
}

TEST(ClockSteps, back_leave_the_camera_its_place) {
    Scene scene = turning_scene();
    scene.config.release = Release::once_placed;
    Pipeline pipeline = make_pipeline(scene);
    double depth_s = 3.0;
    for (const StampedFrame& entry : frames_with_host_back(3.0)) {
        pipeline.on_can(entry.frame, entry.stamp);
        const double at_s = 1e-9 * static_cast<double>(entry.stamp.ns - wall_at(0.0).ns);
        // A camera on the clock of that host, once it is known: as ForeignClock tells it.
        const bool is_in_doubt = at_s > 5.101 && at_s < 7.2;
        if (at_s < depth_s || is_in_doubt || at_s > 8.4) {
            continue;
        }
        pipeline.on_depth(flat_frame(at_s > 7.2 ? at_s - 3.0 : at_s));
        depth_s = at_s + 0.1;
    }
    pipeline.finish();
    EXPECT_EQ(pipeline.times_back(), 1U);
    EXPECT_EQ(pipeline.inputs().depth_frames.front().rejected(DepthReason::out_of_order), 0U)
        << pipeline.inputs_text();
    EXPECT_GE(pipeline.inputs().depth_frames.front().used(), 30U) << pipeline.inputs_text();
}

// A camera that this machine's clock dates does not jump with the bus.
TEST(ClockSteps, ahead_make_images_of_the_time_before_late_and_the_map_no_older) {
    Scene scene = turning_scene();
    scene.config.release = Release::once_placed;
    scene.mapping.map.age = {.stale_after_s = 60, .unknown_after_s = 600};
    Pipeline pipeline = make_pipeline(scene);
    double depth_s = 3.0;
    for (const StampedFrame& entry : frames_with_host_back(-700.0)) {
        pipeline.on_can(entry.frame, entry.stamp);
        const double at_s = 1e-9 * static_cast<double>(entry.stamp.ns - wall_at(0.0).ns);
        if (at_s < depth_s) continue;
        pipeline.on_depth(flat_frame(at_s));
        depth_s = at_s + 0.1;
    }
    pipeline.finish();
    EXPECT_EQ(pipeline.times_ahead(), 1U);
    EXPECT_GE(pipeline.inputs().depth_frames.front().rejected(DepthReason::late), 10U)
        << pipeline.inputs_text();
    EXPECT_NEAR(age_of_oldest_s(pipeline.map()), 5.0, 1.0);
}

TEST(ClockSteps, of_any_number_of_foreign_stamps_do_not_change_the_map) {
    const Scene scene = turning_scene();
    const std::string expected = maps_of(play(scene, scene.bus.frames()));
    wire::CanFrame foreign;
    foreign.can_id = 0x7A1;
    foreign.payload_len = 1;
    for (const double step_s : {3600.0, 0.1, -0.01, -3600.0}) {
        std::vector<StampedFrame> frames;
        for (const StampedFrame& entry : scene.bus.frames()) {
            frames.push_back(entry);
            frames.push_back({{entry.stamp.ns + std::llround(1e9 * step_s)}, foreign});
        }
        EXPECT_TRUE(maps_of(play(scene, frames)) == expected) << step_s;
    }
}

TEST(ClockSteps, of_a_sensor_nodes_clock_put_no_range_in_the_wrong_place) {
    for (const double step_s : {0.02, 0.03, 0.05, 0.1, 0.15, 0.2, 0.24, 0.5, 1.0, 3.0, 100.0, 2000.0}) {
        for (const double sign : {1.0, -1.0}) {
            SCOPED_TRACE("jump of " + std::to_string(sign * step_s) + " s");
            const Pipeline pipeline = play(turning_scene(), frames_with_jump(kLeft, sign * step_s));
            expect_hits_where_shots_ended(pipeline, 60);
            EXPECT_GT(pipeline.inputs().readings.used(), 90U) << pipeline.inputs_text();
        }
    }
}

TEST(ClockSteps, of_the_joint_sources_clock_put_no_range_in_the_wrong_place) {
    for (const double step_s : {0.06, 0.1, 0.5, 5.0, 16.777, 1000.0}) {
        for (const double sign : {1.0, -1.0}) {
            SCOPED_TRACE("jump of " + std::to_string(sign * step_s) + " s");
            const Pipeline pipeline = play(turning_scene(kJoints), frames_with_jump(kJoints, sign * step_s));
            expect_hits_where_shots_ended(pipeline, 60);
            EXPECT_GT(pipeline.inputs().readings.used(), 90U) << pipeline.inputs_text();
        }
    }
}

}  // namespace
}  // namespace octoskin::test
