// The scene of one joint with a second source: a finger of the arm that slides, whose node stops in
// mid-scene.
#include <gtest/gtest.h>

#include <algorithm>

#include "host/io/mapfile/octomap_writer.hpp"
#include "tests/unit/host/core/pipeline/one_joint_scene.hpp"

namespace octoskin {
namespace {

using namespace test;

constexpr wire::NodeId kFinger = 11;
constexpr double kFingerEnds_s = 3.6;

RobotModel arm_with_finger() {
    JointDescription shoulder;
    shoulder.name = "shoulder";
    shoulder.parent_link = "base";
    shoulder.child_link = "arm";
    shoulder.kind = JointKind::revolute;
    shoulder.axis = Eigen::Vector3d::UnitZ();
    shoulder.limits = {-3.2, 3.2, 8.0};
    JointDescription finger;
    finger.name = "finger";
    finger.parent_link = "arm";
    finger.child_link = "tip";
    finger.kind = JointKind::prismatic;
    finger.T_parent_joint.translation().x() = 0.12;
    finger.axis = Eigen::Vector3d::UnitX();
    finger.limits = {0.0, 0.04, 1.0};
    const std::vector<JointDescription> joints = {shoulder, finger};
    const std::vector<std::string> moved = {"shoulder", "finger"};
    return RobotModel::build("base", joints, moved).value();
}

/// kSpare is on the finger. Both sensors have ten readings at the same times; the finger's positions end at
/// `finger_ends_s`.
Scene scene_with_finger(double finger_ends_s) {
    Scene scene = good_scene();
    scene.rig.joint_sources.push_back({.node_id = kFinger, .joints = {"finger"}, .rate_hz = 20.0});
    scene.rig.nodes[0].sensors[kSpare].link = "tip";
    scene.rig.nodes[0].sensors[kSpare].T_link_sensor.translation().x() = 0.0;
    scene.rig.links_ignored_by_sensors.push_back("tip");
    scene.bus.set_clock(kFinger, 55, 20e-6);
    for (int k = 0; k <= 8; ++k) scene.bus.exchange(0.15 + k, {kFinger});
    for (int k = 10; k < 20 * finger_ends_s; ++k) {
        const double position = 0.02;
        scene.bus.joints(0.05 * k + 0.003, kFinger, {&position, 1});
    }
    for (int k = 0; k < 10; ++k) {
        wire::RangeReading reading = good_reading(kSpare);
        reading.range_mm = static_cast<std::uint16_t>(1000 + 10 * k);
        scene.bus.range(3.505 + 0.033 * k, kLeft, reading);
    }
    scene.depth.clear();
    return scene;
}

Pipeline pipeline_of(const Scene& scene) {
    return Pipeline::build(scene.rig, arm_with_finger(), scene.mapping, scene.config).value();
}

Pipeline play_to_end(const Scene& scene) {
    Pipeline pipeline = pipeline_of(scene);
    ScriptedSource can(scene.bus.frames());
    ScriptedDepth depth(scene.depth);
    EXPECT_TRUE(replay(pipeline, can, {&depth}).is_complete());
    EXPECT_TRUE(pipeline.is_balanced());
    return pipeline;
}

TEST(SeveralJointSources, give_one_pose) {
    const Pipeline pipeline = play_to_end(scene_with_finger(9.0));
    EXPECT_EQ(pipeline.inputs().readings.used(), 20U) << pipeline.inputs_text();
    EXPECT_EQ(pipeline.inputs().readings.rejected(), 0U);
    for (const std::uint64_t times : pipeline.builder().robot().times_unknown()) EXPECT_EQ(times, 0U);
}

TEST(SeveralJointSources, that_stop_leave_only_what_they_move_without_a_pose) {
    for (const Release release : {Release::by_capture_time, Release::once_placed}) {
        Scene scene = scene_with_finger(kFingerEnds_s);
        scene.config.release = release;
        const Pipeline pipeline = play_to_end(scene);
        const auto& readings = pipeline.inputs().readings;
        // The finger's last sample is of 3.553 s.
        EXPECT_EQ(readings.used(), 10U + 2U) << pipeline.inputs_text();
        EXPECT_EQ(readings.rejected(ReadingReason::joints_missing), 8U);
        const auto unknown = pipeline.builder().robot().times_unknown();
        EXPECT_EQ(unknown[0], 0U);
        EXPECT_EQ(unknown[1], 16U) << "each of the two sensors' readings asks for a pose";
    }
}

TEST(SeveralJointSources, that_are_silent_delay_no_other_readings_for_long) {
    Scene scene = scene_with_finger(2.0);  // long before the readings
    scene.config.release = Release::once_placed;
    Pipeline pipeline = pipeline_of(scene);
    Nanoseconds longest{0};
    for (const StampedFrame& entry : scene.bus.frames()) {
        pipeline.on_can(entry.frame, entry.stamp);
        for (const HostTime captured : pipeline.just_used())
            longest = std::max(longest, *pipeline.now() - captured);
    }
    EXPECT_EQ(pipeline.inputs().readings.used(), 10U);
    // A reading arrives 15 ms after its capture; its joint sample waits for the successor, 12.5 ms.
    EXPECT_LT(longest, std::chrono::milliseconds(15 + 20)) << longest.count();
}

// A ball of all the places where the finger can be is left out, not the finger alone, and not the whole
// image.
TEST(SeveralJointSources, that_are_silent_leave_the_reach_of_their_bodies_out_of_images) {
    const auto robot_pixels = [](double finger_ends_s) {
        Scene scene = scene_with_finger(finger_ends_s);
        scene.rig.body.push_back({"tip", {0, 0, 0}, {0.02, 0, 0}, 0.005});
        scene.depth = {flat_frame(4.0, 2000), flat_frame(4.2, 2000)};
        const Pipeline pipeline = play_to_end(scene);
        EXPECT_EQ(pipeline.inputs().depth_frames.front().used(), 2U) << pipeline.inputs_text();
        return pipeline.builder().depth_stage(0).robot_pixels();
    };
    const std::uint64_t placed = robot_pixels(9.0);
    const std::uint64_t unplaced = robot_pixels(kFingerEnds_s);
    EXPECT_GE(unplaced, placed);
    EXPECT_LT(unplaced, 2U * 16U * 12U);
}

TEST(SeveralJointSources, replay_to_the_same_bytes_in_the_order_of_a_live_map) {
    Scene scene = scene_with_finger(kFingerEnds_s);
    scene.config.release = Release::once_placed;
    scene.depth = {flat_frame(4.0), flat_frame(4.2)};
    const Pipeline live = play_to_end(scene);
    const Pipeline again = play_to_end(scene);
    EXPECT_EQ(encode_ot(again.map()), encode_ot(live.map()));
}

// Else the order of a live map and its replay would differ: the replay has the samples before the image.
TEST(SeveralJointSources, that_return_while_an_image_is_in_work_leave_it_out) {
    const Scene scene = scene_with_finger(9.0);
    for (const bool returns : {false, true}) {
        MapBuilder builder =
            MapBuilder::build(scene.rig, arm_with_finger(), scene.mapping, {}, {MapFeed::both}).value();
        const auto add = [&builder](double at_s, double position, std::uint8_t source) {
            EXPECT_TRUE(
                builder.add({.sampled = host_at(at_s), .position_rad = {position}, .source = source}));
        };
        for (int k = 100; k <= 130; ++k) add(0.01 * k, 1.0, 0);
        add(1.0, 0.02, 1);
        auto depth = builder.begin(flat_frame(1.05));
        ASSERT_TRUE(depth);
        EXPECT_EQ(depth->robot->unknown, JointSet{2});
        builder.work(*depth);
        if (returns) add(1.08, 0.02, 1);
        const auto finished = builder.finish(*depth);
        EXPECT_EQ(finished.has_value(), !returns);
        if (returns) {
            EXPECT_EQ(finished.error(), DepthReason::late);
        }
    }
}

// Two senders of one source do not touch the other.
TEST(SeveralJointSources, are_checked_for_a_second_sender_one_by_one) {
    Scene scene = scene_with_finger(9.0);
    for (int k = 20; k < 180; ++k) {
        const double position = 0.04;  // as far as the finger goes
        scene.bus.joints(0.05 * k + 0.02, kFinger, {&position, 1});
    }
    const Pipeline pipeline = play_to_end(scene);
    EXPECT_GT(pipeline.intake().joint_senders(1).contradictions(), 0U);
    EXPECT_EQ(pipeline.intake().joint_senders(0).contradictions(), 0U);
    EXPECT_EQ(pipeline.inputs().readings.used(), 10U) << pipeline.inputs_text();
    EXPECT_EQ(pipeline.inputs().readings.rejected(ReadingReason::joints_missing), 10U);
}

}  // namespace
}  // namespace octoskin
