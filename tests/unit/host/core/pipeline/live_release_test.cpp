// A live map: measurements enter it as soon as it is known where the robot was, and no later than the lag.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "host/core/pipeline/pipeline.hpp"
#include "host/io/mapfile/octomap_writer.hpp"
#include "tests/unit/host/core/pipeline/one_joint_scene.hpp"

namespace octoskin {
namespace {

using namespace test;

Scene live_scene() {
    Scene scene = good_scene();
    scene.config.release = Release::once_placed;
    return scene;
}

/// Frames and depth frames in the order of their times, and a look at the pipeline after each.
template <class Look>
Pipeline play(const Scene& scene, const std::vector<StampedFrame>& frames, const Look& look) {
    Pipeline pipeline = make_pipeline(scene);
    auto depth = scene.depth.begin();
    for (const StampedFrame& entry : frames) {
        pipeline.on_can(entry.frame, entry.stamp);
        while (depth != scene.depth.end() && pipeline.now() && depth->captured <= *pipeline.now()) {
            pipeline.on_depth(*depth++);
        }
        look(pipeline);
    }
    pipeline.finish();
    EXPECT_TRUE(pipeline.is_balanced()) << pipeline.inputs_text();
    return pipeline;
}

/// The frames that come before `end_s`; the pipeline may go on.
Pipeline play_on(const Scene& scene, double end_s) {
    Pipeline pipeline = make_pipeline(scene);
    for (const StampedFrame& entry : scene.bus.frames())
        if (entry.stamp < wall_at(end_s)) pipeline.on_can(entry.frame, entry.stamp);
    return pipeline;
}

template <class Look>
Pipeline play(const Scene& scene, const Look& look) {
    return play(scene, scene.bus.frames(), look);
}

std::vector<StampedFrame> with_late_joints(std::vector<StampedFrame> frames) {
    for (StampedFrame& entry : frames) {
        const bool is_joints = wire::type_of(entry.frame.can_id) == wire::FrameType::joint_state;
        entry.stamp.ns += is_joints ? 20'000'000 : 0;
    }
    std::ranges::stable_sort(frames, {}, &StampedFrame::stamp);
    return frames;
}

/// The longest that a reading waited in a scene whose joint states come late.
Nanoseconds longest_wait(Scene scene) {
    scene.depth.clear();
    // A reading arrives 15 ms after it was captured; joints, sampled every 10 ms, 20 ms after that.
    const auto frames = with_late_joints(scene.bus.frames());
    std::uint64_t taken_in = 0;
    Nanoseconds longest{0};
    HostTime came{};
    play(scene, frames, [&](const Pipeline& pipeline) {
        const auto& readings = pipeline.inputs().readings;
        if (!pipeline.now()) return;
        if (readings.in() > taken_in) came = *pipeline.now();
        taken_in = readings.in();
        const bool is_waiting = readings.used() + readings.rejected() < taken_in;
        if (is_waiting) longest = std::max(longest, *pipeline.now() - came);
    });
    EXPECT_EQ(taken_in, 10U);
    EXPECT_GT(longest, Nanoseconds{0});
    return longest;
}

TEST(LiveRelease, takes_a_reading_with_the_first_joint_sample_after_it_where_nobody_else_can_send_one) {
    Scene scene = live_scene();
    scene.rig.joint_sources.at(0).is_local = true;
    EXPECT_LE(longest_wait(scene), std::chrono::milliseconds(10 + 20 - 15 + 1));
}

// Its successor comes 10 ms later, and the next frame after 12.5 ms is that one's.
TEST(LiveRelease, takes_a_reading_once_no_second_sender_of_its_joint_sample_has_come) {
    EXPECT_LE(longest_wait(live_scene()), std::chrono::milliseconds(10 + 20 - 15 + 20 + 1));
}

/// How old each reading was as it came onto the map, in that order.
std::vector<Nanoseconds> ages_on_the_map(Scene scene) {
    scene.depth.clear();
    std::vector<Nanoseconds> ages;
    play(scene, with_late_joints(scene.bus.frames()), [&](const Pipeline& pipeline) {
        for (const HostTime captured : pipeline.just_used()) ages.push_back(*pipeline.now() - captured);
    });
    EXPECT_EQ(ages.size(), 10U);
    return ages;
}

TEST(LiveRelease, tells_which_readings_each_frame_put_onto_the_map_whatever_they_waited_for) {
    Scene local = live_scene();
    local.rig.joint_sources.at(0).is_local = true;
    const auto at_once = ages_on_the_map(local);
    const auto certain = ages_on_the_map(live_scene());
    for (std::size_t i = 0; i < std::min(at_once.size(), certain.size()); ++i) {
        EXPECT_GE(at_once[i], std::chrono::milliseconds(15)) << i;
        EXPECT_LE(at_once[i], std::chrono::milliseconds(10 + 20 + 1)) << i;
        EXPECT_GE(certain[i] - at_once[i], std::chrono::microseconds(12'500)) << i;
        EXPECT_LE(certain[i] - at_once[i], std::chrono::milliseconds(20 + 1)) << i;
    }
}

TEST(LiveRelease, builds_the_map_that_the_order_of_capture_builds_where_the_order_is_the_same) {
    const Pipeline live = play(live_scene(), [](const Pipeline&) {});
    EXPECT_EQ(live.inputs().readings.used(), 10U);
    EXPECT_EQ(live.inputs().depth_frames.front().used(), 6U);
    EXPECT_EQ(encode_ot(live.map()), run(good_scene()).fused_ot);
}

TEST(LiveRelease, gives_the_same_bytes_for_the_same_calls) {
    const Pipeline once = play(live_scene(), [](const Pipeline&) {});
    const Pipeline again = play(live_scene(), [](const Pipeline&) {});
    EXPECT_EQ(encode_ot(once.map()), encode_ot(again.map()));
}

TEST(LiveRelease, gives_up_a_reading_without_joints_once_the_lag_is_over) {
    Scene scene = live_scene();
    // Joints end at 9 s; other frames go on.
    scene.bus.range(8.998, kLeft, good_reading());
    scene.bus.range(9.005, kLeft, good_reading(kSpare));
    for (int k = 0; k < 10; ++k) {
        scene.bus.send(9.1 + 0.05 * k, wire::Heartbeat{.state = wire::NodeState::ranging}, kLeft);
    }
    std::optional<HostTime> given_up;
    const Pipeline pipeline = play(scene, [&](const Pipeline& now) {
        if (!given_up && now.inputs().readings.rejected(ReadingReason::joints_missing) > 0) {
            given_up = now.now();
        }
    });
    EXPECT_EQ(pipeline.inputs().readings.used(), 11U) << pipeline.inputs_text();
    ASSERT_TRUE(given_up) << pipeline.inputs_text();
    EXPECT_GT(*given_up, host_at(9.005) + scene.config.lag - std::chrono::milliseconds(1));
    EXPECT_LT(*given_up, host_at(9.005) + scene.config.lag + std::chrono::milliseconds(60));
}

TEST(LiveRelease, counts_a_reading_in_a_gap_of_the_joints_as_soon_as_the_gap_is_over) {
    Scene scene = live_scene();
    scene.bus.range(7.15, kLeft, good_reading());  // no joints between 7.0 and 7.3 s
    const Pipeline pipeline = play(scene, [](const Pipeline&) {});
    EXPECT_EQ(pipeline.inputs().readings.rejected(ReadingReason::joints_missing), 1U);
    EXPECT_EQ(pipeline.inputs().readings.used(), 10U);
}

TEST(LiveRelease, takes_an_older_reading_after_a_younger_one) {
    Scene scene = live_scene();
    scene.bus.range(3.80, kLeft, good_reading(kSpare), 0.1);  // captured early, arrives 0.1 s later
    const Pipeline pipeline = play(scene, [](const Pipeline&) {});
    EXPECT_EQ(pipeline.inputs().readings.rejected(ReadingReason::late), 0U);
    EXPECT_EQ(pipeline.inputs().readings.used(), 11U) << pipeline.inputs_text();
}

TEST(LiveRelease, takes_a_depth_frame_at_once_if_the_robot_is_not_removed_from_it) {
    Scene scene = live_scene();
    scene.mapping.removes_robot_from_depth = false;
    Pipeline pipeline = make_pipeline(scene);
    pipeline.on_depth(flat_frame(4.0));
    EXPECT_EQ(pipeline.inputs().depth_frames.front().used(), 1U);
}

/// The bus up to 9 s, and then silence that somebody looks at every 50 ms, with an image every 100 ms.
Pipeline play_into_silence(const Scene& scene, double until_s) {
    Pipeline pipeline = play_on(scene, 9.0);
    for (int k = 1; 9.0 + 0.05 * k < until_s; ++k) {
        pipeline.on_silence(host_at(9.0 + 0.05 * k));
        if (k % 2 == 0) pipeline.on_depth(flat_frame(9.0 + 0.05 * k));
    }
    return pipeline;
}

TEST(LiveRelease, uses_images_beside_a_silent_bus_where_the_robot_is_not_removed_from_them) {
    Scene scene = live_scene();
    scene.mapping.removes_robot_from_depth = false;
    Pipeline pipeline = play_into_silence(scene, 12.04);
    EXPECT_EQ(pipeline.inputs().depth_frames.front().used(), 30U) << pipeline.inputs_text();
    pipeline.on_depth(flat_frame(12.99));
    EXPECT_EQ(pipeline.inputs().depth_frames.front().used(), 31U) << "less than a second ahead";
    pipeline.on_depth(flat_frame(13.02));
    EXPECT_EQ(pipeline.inputs().depth_frames.front().rejected(DepthReason::ahead_of_time), 1U);
}

TEST(LiveRelease, gives_up_images_beside_a_silent_bus_that_alone_tells_where_the_robot_is) {
    const Pipeline pipeline = play_into_silence(live_scene(), 12.04);
    const auto& frames = pipeline.inputs().depth_frames.front();
    EXPECT_EQ(frames.in(), 30U);
    EXPECT_EQ(frames.used(), 0U);
    // 27 of them 250 ms old and more.
    EXPECT_EQ(frames.rejected(DepthReason::joints_missing), 27U) << pipeline.inputs_text();
    EXPECT_TRUE(pipeline.is_balanced());
}

TEST(LiveRelease, gives_up_a_reading_that_waits_when_the_bus_falls_silent) {
    Scene scene = live_scene();
    scene.bus.range(9.005, kLeft, good_reading(kSpare));  // no joint state after it
    Pipeline pipeline = play_on(scene, 9.1);
    const auto& readings = pipeline.inputs().readings;
    EXPECT_EQ(readings.rejected(ReadingReason::joints_missing), 0U) << pipeline.inputs_text();
    pipeline.on_silence(host_at(9.24));
    EXPECT_EQ(readings.rejected(ReadingReason::joints_missing), 0U);
    pipeline.on_silence(host_at(9.26));
    EXPECT_EQ(readings.rejected(ReadingReason::joints_missing), 1U) << pipeline.inputs_text();
}

TEST(LiveRelease, takes_the_bus_s_time_again_when_it_speaks_after_a_silence) {
    Scene scene = live_scene();
    Pipeline pipeline = play_on(scene, 4.0);
    pipeline.on_silence(host_at(60.0));
    for (const StampedFrame& entry : scene.bus.frames()) {
        if (entry.stamp >= wall_at(4.0) && entry.stamp < wall_at(5.0))
            pipeline.on_can(entry.frame, entry.stamp);
    }
    pipeline.on_depth(flat_frame(7.0));
    EXPECT_EQ(pipeline.inputs().depth_frames.front().rejected(DepthReason::ahead_of_time), 1U);
}

TEST(LiveRelease, holds_a_depth_frame_until_its_joints_are_here) {
    Scene scene = live_scene();
    scene.depth.clear();
    Pipeline pipeline = make_pipeline(scene);
    bool is_given = false;
    for (const StampedFrame& entry : scene.bus.frames()) {
        pipeline.on_can(entry.frame, entry.stamp);
        if (!is_given && pipeline.now() && *pipeline.now() >= host_at(4.0)) {
            pipeline.on_depth(flat_frame(4.05));
            EXPECT_EQ(pipeline.inputs().depth_frames.front().used(), 0U);
            is_given = true;
        }
        if (is_given && *pipeline.now() >= host_at(4.07)) break;
    }
    EXPECT_EQ(pipeline.inputs().depth_frames.front().used(), 1U);
    pipeline.finish();
}

}  // namespace
}  // namespace octoskin
