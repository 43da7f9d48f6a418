// A map goes on from a snapshot with the camera's memory as if there had been none.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "host/core/pipeline/ordered_replay.hpp"
#include "host/io/mapfile/octomap_writer.hpp"
#include "host/io/snapshot/snapshot.hpp"
#include "tests/support/snapshot/camera_memories.hpp"
#include "tests/support/snapshot/mended.hpp"
#include "tests/unit/host/core/pipeline/one_joint_scene.hpp"

namespace octoskin {
namespace {

using namespace test;

constexpr std::uint32_t kMapping = 1;
constexpr int kFrames = 10;

/// A wall with 3 cm of noise and missing values, before which something comes nearer and goes again.
std::vector<DepthFrame> noisy_frames(unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> noise_mm(0.0, 30.0);
    std::vector<DepthFrame> frames;
    for (int k = 0; k < kFrames; ++k) {
        DepthFrame& frame = frames.emplace_back(flat_frame(4.0 + 0.05 * k));
        for (std::size_t i = 0; i < frame.depth_mm.size(); ++i) {
            const bool is_hidden = k % 7 >= 3 && i % frame.width < 7;
            const double depth_mm = (is_hidden ? 1300.0 - 60.0 * k : 1600.0) + noise_mm(random);
            frame.depth_mm[i] = static_cast<std::uint16_t>(random() % 20 == 0 ? 0 : std::lround(depth_mm));
        }
    }
    return frames;
}

Scene noisy_scene(unsigned seed) {
    Scene scene = good_scene();
    scene.depth = noisy_frames(seed);
    scene.config.release = Release::once_placed;
    scene.config.maps = {MapFeed::both};
    scene.mapping = denoised_mapping();
    scene.mapping.map.resolution_m = 0.04;
    scene.mapping.depth_denoiser.noise = {.constant_m = 0.03};
    return scene;
}

/// Of a camera alone: no frame needs the robot.
Scene camera_scene(unsigned seed) {
    Scene scene = noisy_scene(seed);
    scene.mapping.removes_robot_from_depth = false;
    return scene;
}

MapBuilder make_builder(const Scene& scene) {
    return MapBuilder::build(scene.rig, one_joint_robot(), scene.mapping, scene.config.joints,
                             scene.config.maps)
        .value();
}

std::string encode(const MapBuilder& builder) {
    return encode_snapshot(builder.state(), {.mapping_crc32 = kMapping});
}

MapState decode(const std::string& bytes, const Scene& scene) {
    auto snapshot = decode_snapshot(bytes, scene.mapping, kMapping);
    EXPECT_TRUE(snapshot) << snapshot.error().message();
    return std::move(snapshot->state);
}

MapBuilder resumed(const std::string& bytes, const Scene& scene) {
    MapBuilder builder = make_builder(scene);
    EXPECT_EQ(builder.begin_with(decode(bytes, scene)), MapBuilder::LeftOut{});
    return builder;
}

TEST(ResumedCamera, gives_the_same_maps_from_a_snapshot_after_any_image) {
    for (unsigned seed = 1; seed <= 4; ++seed) {
        const Scene scene = camera_scene(seed);
        MapBuilder live = make_builder(scene);
        std::vector<MapBuilder> others;
        std::vector<MapBuilder> without_memory;
        for (int k = 0; k < kFrames; ++k) {
            const std::string bytes = encode(live);
            others.push_back(resumed(bytes, scene));
            MapState state = decode(bytes, scene);
            EXPECT_EQ(state.cameras.size(), k > 0 ? 1U : 0U);
            state.cameras.clear();
            without_memory.push_back(make_builder(scene));
            EXPECT_EQ(without_memory.back().begin_with(std::move(state)), MapBuilder::LeftOut{});
            ASSERT_TRUE(live.integrate(scene.depth[static_cast<std::size_t>(k)]));
            for (MapBuilder& other : others) {
                ASSERT_TRUE(other.integrate(scene.depth[static_cast<std::size_t>(k)]));
                ASSERT_EQ(encode(other), encode(live)) << "seed " << seed << ", frame " << k;
            }
            for (MapBuilder& other : without_memory)
                ASSERT_TRUE(other.integrate(scene.depth[static_cast<std::size_t>(k)]));
        }
        EXPECT_EQ(encode(without_memory[0]), encode(live));
        for (int k = 1; k < kFrames; ++k)
            EXPECT_NE(encode_ot(without_memory[static_cast<std::size_t>(k)].map()), encode_ot(live.map()))
                << "the memory makes a difference";
    }
}

/// Finishes when it is waited for.
class PatientWorker final : public DepthWorker {
  public:
    void begin(std::function<void()> work) override { work_ = std::move(work); }
    bool is_done() const override { return !work_; }
    void finish() override { end(); }
    void end() {
        if (work_) std::exchange(work_, nullptr)();
    }
    [[nodiscard]] bool is_at_work() const { return work_ != nullptr; }

  private:
    std::function<void()> work_;
};

/// What a recording holds.
class Order final : public CommitListener, public CommitSource {
  public:
    void on_joints(const JointMeasurement& joints) override { commits_.emplace_back(joints); }
    void on_reading(const RangeMeasurement& measurement, const Beam&, std::span<const VoxelUpdate>) override {
        commits_.emplace_back(measurement);
    }
    void on_depth(const DepthFrame& frame, const Evidence&) override {
        commits_.emplace_back(DepthCommit{frames.size(), frame.captured});
        frames.push_back(frame);
    }
    Result<std::optional<Commit>, Error> next() override {
        return next_ < commits_.size() ? std::optional(commits_[next_++]) : std::nullopt;
    }
    std::vector<DepthFrame> frames;

  private:
    std::vector<Commit> commits_;
    std::size_t next_ = 0;
};

/// Plays the scene with a worker that ends a frame seven frames of the bus after it began. Another pipeline
/// with `begins_after` images in its map is recorded from the moment on when the worker has, or has not, a
/// frame in work.
struct Recorded {
    std::string first;
    std::string last;
    Order order;
};

void play(const Scene& scene, std::uint64_t begins_after, bool is_amid_work, Recorded& recorded) {
    Pipeline pipeline = make_pipeline(scene);
    PatientWorker worker;
    pipeline.work_beside({&worker});
    auto depth = scene.depth.begin();
    int since = 0;
    for (const StampedFrame& entry : scene.bus.frames()) {
        pipeline.on_can(entry.frame, entry.stamp);
        while (depth != scene.depth.end() && pipeline.now() && depth->captured <= *pipeline.now())
            pipeline.on_depth(*depth++);
        since = worker.is_at_work() ? since + 1 : 0;
        const bool begins = recorded.first.empty() && worker.is_at_work() == is_amid_work &&
                            pipeline.inputs().depth_frames.front().used() >= begins_after;
        if (begins) {
            recorded.first = encode(pipeline.builder());
            pipeline.builder().for_each_joint_sample(
                [&](const JointMeasurement& joints) { recorded.order.on_joints(joints); });
            pipeline.set_listener(&recorded.order);
        }
        if (since < 3) continue;
        worker.end();
        pipeline.on_worker_done();
    }
    pipeline.finish();
    EXPECT_EQ(pipeline.inputs().depth_frames.front().used(), static_cast<std::uint64_t>(kFrames));
    recorded.last = encode(pipeline.builder());
}

TEST(ResumedCamera, gives_the_recorded_map_where_the_recording_begins_while_an_image_is_in_work) {
    const Scene scene = noisy_scene(3);
    Recorded unrecorded;
    play(scene, 1000, false, unrecorded);
    for (const bool is_amid_work : {false, true}) {
        for (const std::uint64_t begins_after : {0U, 1U, 5U, 9U}) {
            Recorded recorded;
            play(scene, begins_after, is_amid_work, recorded);
            EXPECT_TRUE(recorded.last == unrecorded.last) << "a recording leaves the map alone";
            EXPECT_EQ(recorded.order.frames.size(), kFrames - begins_after);
            MapBuilder builder = resumed(recorded.first, scene);
            ScriptedDepth depth(recorded.order.frames);
            EXPECT_TRUE(replay_in_order(builder, recorded.order, {&depth}).took_all());
            EXPECT_TRUE(encode(builder) == recorded.last) << begins_after << (is_amid_work ? " amid" : "");
        }
    }
}

TEST(ResumedCamera, of_another_size_or_pose_or_without_a_memory_is_left_out) {
    const Scene scene = camera_scene(1);
    MapBuilder live = make_builder(scene);
    for (int k = 0; k < 5; ++k) ASSERT_TRUE(live.integrate(scene.depth[static_cast<std::size_t>(k)]));
    const auto is_left_out = [&](const Scene& other) {
        MapBuilder builder = make_builder(other);
        const MapBuilder::LeftOut left_out = builder.begin_with(live.state());
        EXPECT_EQ(left_out.zones, 0U);
        EXPECT_NE(builder.camera_memories().empty(), left_out.cameras.empty());
        EXPECT_EQ(encode_ot(builder.map()), encode_ot(live.map()));
        return left_out.cameras == std::vector<std::string>{""};
    };
    EXPECT_FALSE(is_left_out(scene));
    Scene other = scene;
    other.rig.cameras.front().intrinsics.width = 12;
    other.rig.cameras.front().intrinsics.height = 16;
    EXPECT_TRUE(is_left_out(other)) << "as many pixels";
    other = scene;
    other.rig.cameras.front().T_link_camera.translation().x() += 1e-9;
    EXPECT_TRUE(is_left_out(other));
    other = scene;
    other.mapping.depth_update = DepthUpdate::paper;
    EXPECT_TRUE(is_left_out(other));
    other = scene;
    other.rig.cameras.front().name = "left";
    EXPECT_TRUE(is_left_out(other)) << "another camera";
    other = scene;
    other.rig.cameras.clear();
    EXPECT_TRUE(is_left_out(other));
}

TEST(ResumedCamera, is_forgotten_where_a_builder_begins_with_a_state_without_one) {
    const Scene scene = camera_scene(2);
    MapBuilder used = make_builder(scene);
    MapBuilder fresh = make_builder(scene);
    for (int k = 0; k < 3; ++k) ASSERT_TRUE(used.integrate(scene.depth[static_cast<std::size_t>(k)]));
    for (MapBuilder* builder : {&used, &fresh}) {
        EXPECT_EQ(builder->begin_with({FusedMap(scene.mapping.map), {}}), MapBuilder::LeftOut{});
        EXPECT_TRUE(builder->camera_memories().empty());
        for (int k = 3; k < kFrames; ++k)
            ASSERT_TRUE(builder->integrate(scene.depth[static_cast<std::size_t>(k)]));
    }
    EXPECT_EQ(encode(used), encode(fresh));
}

/// Memories that no camera has made, and that are accepted all the same.
TEST(ResumedCamera, goes_on_from_any_memory_that_is_accepted) {
    const Scene scene = camera_scene(4);
    std::mt19937 random(6);
    int accepted = 0;
    for (unsigned seed = 1; seed <= 60; ++seed) {
        MapBuilder live = make_builder(scene);
        ASSERT_TRUE(live.integrate(scene.depth[0]));
        MapState state = live.state();
        const Eigen::Isometry3d T_map_camera = state.cameras.front().T_map_camera;
        state.cameras = {testing_support::random_camera(seed, 16, 12, 0.9F)};
        state.cameras.front().T_map_camera = T_map_camera;
        std::string bytes = encode_snapshot(state, {.mapping_crc32 = kMapping});
        const std::size_t from = bytes.find("CAMR") + 12 + 105;
        for (int change = 0; change < 3; ++change)
            bytes[from + random() % (bytes.rfind("DONE") - from)] = static_cast<char>(random());
        auto snapshot = decode_snapshot(testing_support::mended(bytes), scene.mapping, kMapping);
        if (!snapshot) continue;
        ++accepted;
        MapBuilder builder = make_builder(scene);
        ASSERT_EQ(builder.begin_with(std::move(snapshot->state)), MapBuilder::LeftOut{});
        for (const DepthFrame& frame : scene.depth) {
            ASSERT_TRUE(builder.integrate(frame));
            ASSERT_TRUE(decode_snapshot(encode(builder), scene.mapping, kMapping));
        }
    }
    EXPECT_GT(accepted, 10);
}

}  // namespace
}  // namespace octoskin
