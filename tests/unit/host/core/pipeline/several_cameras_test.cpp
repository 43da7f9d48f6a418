// Two cameras: each is filtered, remembered, counted and lost by itself, and both make one map.
#include <gtest/gtest.h>

#include <array>
#include <memory>

#include "host/core/pipeline/ordered_replay.hpp"
#include "host/io/mapfile/octomap_writer.hpp"
#include "tests/unit/host/core/pipeline/one_joint_scene.hpp"
#include "tests/unit/host/core/pipeline/patient_worker.hpp"

namespace octoskin {
namespace {

using namespace test;

constexpr std::uint8_t kFront = 0;
constexpr std::uint8_t kBack = 1;

/// The scene's camera, and a second one a metre beside it that has fewer and larger pixels.
HostRig two_camera_rig() {
    HostRig rig = one_joint_rig();
    rig.cameras.front().name = "front";
    HostCamera back = rig.cameras.front();
    back.name = "back";
    back.intrinsics.width = 8;
    back.intrinsics.height = 6;
    back.intrinsics.fx /= 2.0;
    back.intrinsics.fy /= 2.0;
    back.intrinsics.cx /= 2.0;
    back.intrinsics.cy /= 2.0;
    back.T_link_camera.translation().x() += 1.0;
    rig.cameras.push_back(back);
    return rig;
}

DepthFrame frame_of(std::uint8_t camera, double captured_s, std::uint16_t depth_mm) {
    DepthFrame frame = flat_frame(captured_s, depth_mm);
    if (camera == kBack) {
        frame.width = 8;
        frame.height = 6;
        frame.depth_mm.assign(std::size_t{8} * 6, depth_mm);
    }
    frame.camera = camera;
    return frame;
}

std::vector<DepthFrame> frames_of(std::uint8_t camera, double from_s, int count) {
    std::vector<DepthFrame> frames;
    for (int k = 0; k < count; ++k)
        frames.push_back(frame_of(camera, from_s + 0.1 * k, static_cast<std::uint16_t>(1500 + 7 * k)));
    return frames;
}

Scene two_camera_scene() {
    Scene scene = good_scene();
    scene.rig = two_camera_rig();
    scene.mapping = denoised_mapping();
    scene.mapping.map.resolution_m = plain_mapping().map.resolution_m;
    scene.depth.clear();
    return scene;
}

/// A replay with the frames of each camera, by its index in the rig.
Pipeline replayed(const Scene& scene, const std::vector<std::vector<DepthFrame>>& frames) {
    Pipeline pipeline = make_pipeline(scene);
    ScriptedSource can(scene.bus.frames());
    std::vector<std::unique_ptr<ScriptedDepth>> sources;
    DepthSources depth;
    for (const auto& of_camera : frames) {
        sources.push_back(std::make_unique<ScriptedDepth>(of_camera));
        depth.push_back(sources.back().get());
    }
    EXPECT_TRUE(replay(pipeline, can, depth).is_complete());
    EXPECT_TRUE(pipeline.is_balanced()) << pipeline.inputs_text();
    return pipeline;
}

TEST(SeveralCameras, are_counted_each_and_all_in_one_map) {
    const Scene scene = two_camera_scene();
    const Pipeline both = replayed(scene, {frames_of(kFront, 4.0, 6), frames_of(kBack, 4.03, 5)});
    EXPECT_EQ(both.inputs().depth_frames[kFront].used(), 6U) << both.inputs_text();
    EXPECT_EQ(both.inputs().depth_frames[kBack].used(), 5U) << both.inputs_text();
    EXPECT_EQ(both.counter_tables().back().title(), "depth frames of back");
    const Pipeline front = replayed(scene, {frames_of(kFront, 4.0, 6)});
    const Pipeline back = replayed(scene, {{}, frames_of(kBack, 4.03, 5)});
    EXPECT_GT(both.map().known_voxels(), front.map().known_voxels());
    EXPECT_GT(both.map().known_voxels(), back.map().known_voxels());
}

TEST(SeveralCameras, make_the_same_map_in_any_order_of_the_rig) {
    Scene scene = two_camera_scene();
    const auto front = frames_of(kFront, 4.0, 6);
    const auto back = frames_of(kBack, 4.03, 6);  // at no time of the front's
    const std::string map = encode_ot(replayed(scene, {front, back}).map());
    std::swap(scene.rig.cameras[0], scene.rig.cameras[1]);
    EXPECT_EQ(encode_ot(replayed(scene, {back, front}).map()), map);
}

TEST(SeveralCameras, make_the_same_map_in_any_order_of_the_rig_also_of_images_of_one_time) {
    Scene scene = two_camera_scene();
    const auto front = frames_of(kFront, 4.0, 6);
    const auto back = frames_of(kBack, 4.0, 6);
    const std::string map = encode_ot(replayed(scene, {front, back}).map());
    std::swap(scene.rig.cameras[0], scene.rig.cameras[1]);
    EXPECT_EQ(encode_ot(replayed(scene, {back, front}).map()), map);
}

TEST(SeveralCameras, build_each_on_its_own_earlier_images) {
    // A camera whose images all have values remembers them, whatever the other one sees meanwhile.
    const Scene scene = two_camera_scene();
    const Pipeline both = replayed(scene, {frames_of(kFront, 4.0, 6), frames_of(kBack, 4.03, 5)});
    const Pipeline front = replayed(scene, {frames_of(kFront, 4.0, 6)});
    const auto of_both = both.builder().camera_memories();
    const auto of_front = front.builder().camera_memories();
    ASSERT_EQ(of_both.size(), 2U);
    ASSERT_EQ(of_front.size(), 1U);
    EXPECT_EQ(of_both[kFront].name, "front");
    EXPECT_EQ(of_both[kBack].name, "back");
    EXPECT_TRUE(of_both[kFront].pixels == of_front[0].pixels);
}

TEST(SeveralCameras, are_lost_and_late_each_by_itself) {
    const Scene scene = two_camera_scene();
    auto back = frames_of(kBack, 4.03, 2);
    back.push_back(frame_of(kBack, 4.05, 1500));   // before the one at 4.13 s
    back.push_back(frame_of(kFront, 4.25, 1500));  // of the other camera's size
    const Pipeline pipeline = replayed(scene, {frames_of(kFront, 4.0, 6), back});
    EXPECT_EQ(pipeline.inputs().depth_frames[kFront].used(), 6U) << pipeline.inputs_text();
    const auto& of_back = pipeline.inputs().depth_frames[kBack];
    EXPECT_EQ(of_back.used(), 2U) << pipeline.inputs_text();
    EXPECT_EQ(of_back.rejected(DepthReason::out_of_order), 1U);
    EXPECT_EQ(of_back.rejected(DepthReason::wrong_size), 1U);
    EXPECT_EQ(pipeline.builder().depth_stage(kFront).wrong_size().frames, 0U);
    EXPECT_EQ(pipeline.builder().depth_stage(kBack).wrong_size().frames, 1U);
    EXPECT_EQ(pipeline.builder().depth_stage(kBack).wrong_size().width, 16U);
    EXPECT_TRUE(pipeline.is_camera_stale(kBack));
}

TEST(SeveralCameras, refuse_a_frame_of_a_camera_that_the_rig_does_not_have) {
    Scene scene = two_camera_scene();
    Pipeline pipeline = make_pipeline(scene);
    DepthFrame frame = frame_of(kFront, 4.0, 1500);
    frame.camera = 2;
    pipeline.on_depth(frame);
    pipeline.finish();
    EXPECT_EQ(pipeline.inputs().depth_frames[kFront].rejected(DepthReason::no_camera), 1U);
    EXPECT_TRUE(pipeline.is_balanced());
}

TEST(SeveralCameras, have_each_its_own_noise) {
    Scene scene = two_camera_scene();
    scene.rig.cameras[kBack].noise = DepthNoiseLaw{.constant_m = 0.001};
    const Pipeline pipeline = make_pipeline(scene);
    const MappingConfig of_back = mapping_of(scene.rig.cameras[kBack], scene.mapping);
    EXPECT_EQ(of_back.camera_sigma_m(), 0.001);
    EXPECT_EQ(mapping_of(scene.rig.cameras[kFront], scene.mapping), scene.mapping);
    const auto front = frames_of(kFront, 4.0, 6);
    const auto back = frames_of(kBack, 4.03, 6);
    const std::string quiet = encode_ot(replayed(scene, {front, back}).map());
    scene.rig.cameras[kBack].noise = DepthNoiseLaw{.constant_m = 0.1};
    EXPECT_NE(encode_ot(replayed(scene, {front, back}).map()), quiet);
}

// The front's image takes longer than the back's: the order in which they end is the order of the replay.
TEST(SeveralCameras, work_beside_each_other_and_replay_in_the_order_of_the_live_map) {
    Scene scene = two_camera_scene();
    scene.config.release = Release::once_placed;
    Pipeline live = make_pipeline(scene);
    std::array<PatientWorker, 2> workers;
    CommitOrder order;
    live.set_listener(&order);
    live.work_beside({&workers[kFront], &workers[kBack]});
    auto front = frames_of(kFront, 4.0, 5);
    auto back = frames_of(kBack, 4.01, 5);
    std::size_t given = 0;
    bool were_both_at_work = false;
    for (const StampedFrame& entry : scene.bus.frames()) {
        live.on_can(entry.frame, entry.stamp);
        if (given < front.size() && live.now() && back[given].captured <= *live.now()) {
            live.on_depth(front[given]);
            live.on_depth(back[given]);
            ++given;
        }
        were_both_at_work |= workers[kFront].has_work() && workers[kBack].has_work();
        if (!workers[kBack].has_work()) continue;
        workers[kBack].end();
        live.on_worker_done();
        if (given % 2 == 0) workers[kFront].end();
        live.on_worker_done();
    }
    live.finish();
    EXPECT_TRUE(live.is_balanced()) << live.inputs_text();
    EXPECT_TRUE(were_both_at_work);
    ASSERT_FALSE(order.cameras().empty());
    EXPECT_EQ(order.cameras().front(), kBack) << "the front's was begun first, and ended later";
    EXPECT_EQ(live.inputs().depth_frames[kBack].used(), 5U) << live.inputs_text();

    Pipeline again = make_pipeline(scene);
    ScriptedDepth of_front(order.frames(kFront));
    ScriptedDepth of_back(order.frames(kBack));
    const OrderedOutcome outcome = replay_in_order(again.builder(), order, {&of_front, &of_back});
    EXPECT_TRUE(outcome.took_all());
    EXPECT_EQ(encode_ot(again.map()), encode_ot(live.map()));
}

}  // namespace
}  // namespace octoskin
