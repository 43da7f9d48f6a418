// From frames to voxels: literal maps, and what must not matter.
#include "host/core/pipeline/pipeline.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>

#include "common/range_status.hpp"
#include "host/io/candump/log_line.hpp"
#include "host/io/mapfile/octomap_writer.hpp"
#include "tests/unit/host/core/pipeline/one_joint_scene.hpp"

namespace octoskin {
namespace {

using namespace test;

std::map<VoxelKey, float> voxels(const FusedMap& map) {
    std::map<VoxelKey, float> known;
    map.for_each_known([&](VoxelKey key, float log_odds) { known[key] = log_odds; });
    return known;
}

VoxelKey key(int x, int y, int z) {
    return {static_cast<std::uint16_t>(32768 + x), static_cast<std::uint16_t>(32768 + y),
            static_cast<std::uint16_t>(32768 + z)};
}

/// One exchange a second, joints at 100 Hz, node 1 well: without measurements.
Scene quiet_scene() {
    Scene scene = good_scene();
    scene.depth.clear();
    scene.bus = ScriptedBus{};
    for (int k = 0; k <= 8; ++k) {
        scene.bus.exchange(0.1 + k, {kLeft, kJoints});
    }
    keep_alive(scene, kLeft);
    for (int k = 50; k <= 900; ++k) {
        const double position = angle_at(0.01 * k);
        scene.bus.joints(0.01 * k, kJoints, {&position, 1});
    }
    return scene;
}

Pipeline play(const Scene& scene) {
    Pipeline pipeline = make_pipeline(scene);
    ScriptedSource can(scene.bus.frames());
    ScriptedDepth depth(scene.depth);
    EXPECT_TRUE(replay(pipeline, can, {&depth}).is_complete());
    EXPECT_TRUE(pipeline.is_balanced()) << pipeline.inputs_text();
    return pipeline;
}

TEST(Pipeline, places_one_range_at_the_joint_position_of_its_own_capture_time) {
    // Captured at pi/2 between samples 40 mrad to either side: 26 mm at the endpoint, one voxel off with
    // either.
    Scene scene = quiet_scene();
    scene.bus.range(3.505, kLeft, good_reading());
    const Pipeline pipeline = play(scene);

    // Origin (0.02, 0.14, 0.02), endpoint (0.02, 0.66, 0.02): voxels 3 to 15 passed, 16 hit with 1 - 0.07 *
    // 0.52.
    std::map<VoxelKey, float> expected;
    for (int y = 3; y <= 15; ++y) {
        expected[key(0, y, 0)] = -0.4F;
    }
    expected[key(0, 16, 0)] = 0.9636F;
    EXPECT_EQ(voxels(pipeline.map(MapFeed::ranges)), expected);
    EXPECT_EQ(voxels(pipeline.map()), expected);
    EXPECT_TRUE(voxels(pipeline.map(MapFeed::camera)).empty());
    EXPECT_EQ(pipeline.inputs().readings.used(), 1U);
}

TEST(Pipeline, tells_a_sensor_whose_readings_are_all_rejected_at_the_gate_or_in_the_map) {
    Scene scene = quiet_scene();
    for (int k = 0; k < 40; ++k) {
        wire::RangeReading bad = good_reading(kSpare);
        bad.device_status = 7;
        for (const wire::RangeReading& reading : {good_reading(), good_reading(kFar), bad}) {
            scene.bus.range(3.0 + 0.06 * k, kLeft, reading);
        }
    }
    const Pipeline pipeline = play(scene);
    const auto streak = [&](std::uint8_t sensor) {
        return pipeline.intake().ranges().record(kLeft, sensor).fates.streak();
    };
    EXPECT_EQ(streak(kGood), std::nullopt);
    EXPECT_EQ(streak(kFar), ReadingReason::outside_map);
    EXPECT_EQ(streak(kSpare), ReadingReason::status_fault);
    EXPECT_EQ(streak(kInward), std::nullopt) << "it has said nothing";
}

TEST(Pipeline, places_a_range_of_a_fd_frame_the_same_way) {
    Scene scene = quiet_scene();
    wire::RangeFd frame;
    frame.count = 2;
    frame.entries[0].reading = good_reading();
    frame.entries[0].reading.capture = wire::fd_residue(scene.bus.node_time(kLeft, 3.505));
    frame.entries[1] = frame.entries[0];
    frame.entries[1].reading.sensor = kSpare;
    frame.entries[1].reading.device_status = 7;
    scene.bus.send(3.52, frame, kLeft);
    const Pipeline pipeline = play(scene);
    EXPECT_EQ(voxels(pipeline.map(MapFeed::ranges)).size(), 14U);
    EXPECT_FLOAT_EQ(voxels(pipeline.map(MapFeed::ranges)).at(key(0, 16, 0)), 0.9636F);
    EXPECT_EQ(pipeline.inputs().readings.in(), 2U);
    EXPECT_EQ(pipeline.inputs().readings.rejected(ReadingReason::status_fault), 1U);
}

TEST(Pipeline, places_a_depth_frame_and_leaves_the_robot_out) {
    Scene scene = quiet_scene();
    // One pixel, from (1.02, 0.02, 0.02) in the map along -x.
    scene.rig.cameras.front().intrinsics = {
        .width = 1, .height = 1, .fx = 1.0, .fy = 1.0, .cx = 0.5, .cy = 0.5};
    scene.rig.cameras.front().T_link_camera.translation() = Eigen::Vector3d(1.0, 0.0, 0.0);
    const auto pixel = [](double captured_s, std::uint16_t depth_mm) {
        return DepthFrame{.captured = host_at(captured_s), .width = 1, .height = 1, .depth_mm = {depth_mm}};
    };
    // 0.6 m: endpoint at x = 0.42, voxel 10. 0.95 m: 0.05 m from the axis, on the column; behind: on its far
    // side.
    scene.depth = {pixel(4.0, 600), pixel(4.1, 950), pixel(4.2, 1130)};
    const Pipeline pipeline = play(scene);
    std::map<VoxelKey, float> expected;
    for (int x = 11; x <= 25; ++x) {
        expected[key(x, 0, 0)] = -0.4F;
    }
    expected[key(10, 0, 0)] = 0.94F;
    EXPECT_EQ(voxels(pipeline.map(MapFeed::camera)), expected);
    EXPECT_EQ(voxels(pipeline.map()), expected);
    EXPECT_EQ(pipeline.inputs().depth_frames.front().used(), 3U);
    EXPECT_EQ(pipeline.builder().depth_stage(0).robot_pixels(), 2U);
}

TEST(Pipeline, filters_a_depth_frame_if_told_so) {
    Scene scene = quiet_scene();
    // One pixel stands 0.5 m before its neighbours: none of them supports it.
    scene.depth = {flat_frame(4.0)};
    scene.depth[0].depth_mm[5 * 16 + 8] = 1000;
    const auto is_hit_there = [](const Pipeline& pipeline) {
        // 1 m along the axis from (2.02, 0.02, 0.52), half a pixel to the right and up.
        const auto found = pipeline.map(MapFeed::camera).key_of({1.02, 0.02 + 0.025, 0.52 + 0.025});
        return pipeline.map(MapFeed::camera).occupancy(*found) == Occupancy::occupied;
    };
    EXPECT_TRUE(is_hit_there(play(scene)));
    scene.mapping.depth_filter.is_enabled = true;
    EXPECT_FALSE(is_hit_there(play(scene)));
}

TEST(Pipeline, is_not_hurried_by_a_depth_frame_that_comes_early) {
    const Scene scene = good_scene();
    std::vector<StampedFrame> frames = scene.bus.frames();
    for (StampedFrame& entry : frames) {  // joints come 40 ms late: what is released at once has no pose yet
        entry.stamp.ns += wire::type_of(entry.frame.can_id) == wire::FrameType::joint_state ? 40'000'000 : 0;
    }
    std::ranges::stable_sort(frames, {}, &StampedFrame::stamp);
    Pipeline pipeline = make_pipeline(scene);
    bool has_fed = false;
    for (const StampedFrame& entry : frames) {
        pipeline.on_can(entry.frame, entry.stamp);
        if (pipeline.now() && *pipeline.now() >= host_at(3.7) && !has_fed) {
            pipeline.on_depth(flat_frame(4.6));
            has_fed = true;
        }
    }
    pipeline.finish();
    EXPECT_EQ(pipeline.inputs().readings.used(), 10U) << pipeline.inputs_text();
    EXPECT_EQ(pipeline.inputs().depth_frames.front().used(), 1U);
}

TEST(Pipeline, calls_late_only_what_the_map_itself_has_passed) {
    Scene scene = good_scene();
    scene.config.lag = std::chrono::milliseconds(101);
    scene.bus.range(3.8985, kLeft, good_reading(kInward));  // ends on the robot
    scene.bus.range(3.8980, kLeft, good_reading(kSpare),
                    0.1095);  // captured before it, comes after it was released
    const Pipeline pipeline = play(scene);
    EXPECT_EQ(pipeline.inputs().readings.rejected(ReadingReason::self_hit), 1U);
    EXPECT_EQ(pipeline.inputs().readings.used(), 11U) << pipeline.inputs_text();
}

TEST(Pipeline, adds_both_kinds_of_measurement_to_the_fused_map_in_the_order_of_capture) {
    const RunResult all = run(good_scene());
    EXPECT_EQ(all.inputs.readings.used(), 10U);
    EXPECT_EQ(all.inputs.depth_frames.front().used(), 6U);
    EXPECT_NE(all.depth_ot, all.fused_ot);
    EXPECT_NE(all.proximity_ot, all.fused_ot);
    Scene no_depth = good_scene();
    no_depth.depth.clear();
    EXPECT_EQ(run(no_depth).proximity_ot, all.proximity_ot);
    EXPECT_EQ(run(no_depth).fused_ot, all.proximity_ot);
}

TEST(Pipeline, clears_space_with_beams_without_return_only_up_to_the_configured_distance) {
    Scene scene = quiet_scene();
    scene.mapping.no_return_clear_m = 0.2;
    wire::RangeReading nothing = good_reading();
    nothing.device_status = kDeviceStatusNoTarget;
    scene.bus.range(3.505, kLeft, nothing);
    const Pipeline pipeline = play(scene);
    // From 0.14 to 0.34 along y: voxels 3 to 7 are passed, the one where the limit lies is not; no hit.
    std::map<VoxelKey, float> expected;
    for (int y = 3; y <= 7; ++y) {
        expected[key(0, y, 0)] = -0.4F;
    }
    EXPECT_EQ(voxels(pipeline.map(MapFeed::ranges)), expected);
}

TEST(Pipeline, gives_the_same_bytes_every_time) {
    const Scene scene = good_scene();
    EXPECT_TRUE(run(scene).has_equal_maps(run(scene)));
}

TEST(Pipeline, gives_the_same_bytes_from_the_lines_of_a_candump_log) {
    const Scene scene = good_scene();
    std::vector<StampedFrame> logged;
    for (const StampedFrame& entry : scene.bus.frames()) {
        std::string line = candump::format_line({entry.stamp, "can0", entry.frame});
        line.pop_back();
        const auto read = candump::parse_line(line);
        ASSERT_TRUE(read.has_value()) << line;
        logged.push_back({read->stamp, read->frame});
    }
    EXPECT_TRUE(run(scene, logged).has_equal_maps(run(scene)));
}

TEST(Pipeline, builds_only_the_maps_asked_for) {
    Scene scene = good_scene();
    scene.config.maps = {MapFeed::both};
    const Pipeline pipeline = play(scene);
    EXPECT_EQ(find_map(pipeline.maps(), MapFeed::camera), nullptr);
    EXPECT_EQ(find_map(pipeline.maps(), MapFeed::ranges), nullptr);
    EXPECT_EQ(encode_ot(pipeline.map()), run(good_scene()).fused_ot);
}

TEST(Pipeline, gives_the_same_bytes_in_whatever_order_frames_arrive_within_the_lag) {
    const Scene scene = good_scene();
    const RunResult in_order = run(scene);
    const std::vector<StampedFrame> frames = scene.bus.frames();
    for (std::uint32_t seed = 0; seed < 8; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        std::mt19937 random(seed);
        // Up to 40 ms late each, by measurement and by exchange alike; SYNC itself is stamped where it
        // happens.
        std::uniform_int_distribution<std::int64_t> delay_ns(0, 40'000'000);
        std::vector<StampedFrame> late = frames;
        for (StampedFrame& entry : late) {
            const bool is_sync = entry.frame.can_id == wire::can_id(wire::FrameType::sync, wire::kHostId);
            entry.stamp.ns += is_sync ? 0 : delay_ns(random);
        }
        std::ranges::stable_sort(late, {}, &StampedFrame::stamp);
        const RunResult shuffled = run(scene, late);
        EXPECT_TRUE(shuffled.has_equal_maps(in_order)) << shuffled.inputs_text << in_order.inputs_text;
        EXPECT_EQ(shuffled.inputs.readings.used(), 10U);
    }
}

// Before a reload: a map that took more than the memory to come would be refused at the next start.
TEST(Pipeline, takes_no_space_for_what_waits_beyond_a_memory_that_it_is_given_meanwhile) {
    const Scene scene = good_scene();
    Pipeline pipeline = make_pipeline(scene);
    for (const StampedFrame& entry : scene.bus.frames()) {
        pipeline.on_can(entry.frame, entry.stamp);
        if (pipeline.now() && *pipeline.now() >= HostTime{3'700'000'000}) break;  // the first: 3.505 s
    }
    ASSERT_EQ(pipeline.map().known_voxels(), 0U) << "the reading has to wait yet";
    MapConfig none = scene.mapping.map;
    none.memory_max_mib = 0;
    pipeline.limit_map(none);
    pipeline.finish();
    EXPECT_EQ(pipeline.map().known_voxels(), 0U);
    EXPECT_GT(pipeline.map().counters().no_room, 0U);
    EXPECT_GT(pipeline.map(MapFeed::ranges).known_voxels(), 0U) << "nothing waited";
}

TEST(Pipeline, says_when_the_camera_is_stale) {
    const Scene scene = good_scene();
    Pipeline pipeline = make_pipeline(scene);
    EXPECT_FALSE(pipeline.is_camera_stale(0)) << "no time yet";
    bool has_fed = false;
    for (const StampedFrame& entry : scene.bus.frames()) {
        pipeline.on_can(entry.frame, entry.stamp);
        const auto now = pipeline.now();
        if (now && *now >= host_at(4.0) && !has_fed) {
            EXPECT_TRUE(pipeline.is_camera_stale(0));
            pipeline.on_depth(flat_frame(4.0));
            has_fed = true;
        }
        if (now && has_fed && *now < host_at(4.3)) {
            EXPECT_FALSE(pipeline.is_camera_stale(0));
        }
        if (now && *now > host_at(4.31)) {
            EXPECT_TRUE(pipeline.is_camera_stale(0));
        }
    }
    pipeline.finish();
    EXPECT_TRUE(pipeline.is_balanced());
}

TEST(Pipeline, refuses_by_name_a_link_that_the_robot_does_not_have) {
    const auto refused = [](auto change) {
        HostRig rig = one_joint_rig();
        change(rig);
        const auto pipeline = Pipeline::build(rig, one_joint_robot(), plain_mapping());
        return pipeline ? std::string() : pipeline.error().element;
    };
    EXPECT_EQ(refused([](HostRig& rig) { rig.nodes[0].sensors[0].link = "elbow"; }), "elbow");
    EXPECT_EQ(refused([](HostRig& rig) { rig.body[1].link = "wrist"; }), "wrist");
    EXPECT_EQ(refused([](HostRig& rig) { rig.links_ignored_by_sensors = {"hand"}; }), "hand");
}

TEST(Pipeline, maps_with_a_camera_alone_where_the_robot_need_not_be_taken_out) {
    Scene scene = good_scene();
    scene.bus = ScriptedBus{};
    scene.mapping.removes_robot_from_depth = false;
    const RunResult result = run(scene);
    EXPECT_EQ(result.inputs.depth_frames.front().used(), 6U);
}

}  // namespace
}  // namespace octoskin
