// A live pipeline is recorded from any moment on; what was recorded, through its text, gives its map again.
#include "host/core/pipeline/ordered_replay.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "host/io/mapfile/octomap_writer.hpp"
#include "host/io/orderlog/order_line.hpp"
#include "host/io/snapshot/snapshot.hpp"
#include "tests/unit/host/core/pipeline/one_joint_scene.hpp"

namespace octoskin {
namespace {

using namespace test;

const orderlog::CommitForm kForm{.joints = {1}};

/// What a recorder keeps of a run.
class Saver final : public CommitListener {
  public:
    void on_joints(const JointMeasurement& joints) override { put(joints); }
    void on_reading(const RangeMeasurement& reading, const Beam&, std::span<const VoxelUpdate>) override {
        put(reading);
    }
    void on_depth(const DepthFrame& frame, const Evidence&) override {
        put(DepthCommit{frames.size(), frame.captured});
        frames.push_back(frame);
        frames.back().captured.ns += 999;  // the order's time counts, not that of the frame's recording
    }
    void on_wait(const WaitCommit& passed) override { put(passed); }
    void put(const Commit& commit) { text += orderlog::format_commit(commit, kForm); }

    std::string text;
    std::vector<DepthFrame> frames;
};

class TextSource final : public CommitSource {
  public:
    explicit TextSource(const std::string& text, orderlog::CommitForm form = kForm)
        : text_(text), form_(std::move(form)) {}
    Result<std::optional<Commit>, Error> next() override {
        std::string line;
        if (!std::getline(text_, line)) return std::optional<Commit>{};
        auto commit = orderlog::parse_commit(line, form_);
        EXPECT_TRUE(commit) << line;
        return commit;
    }

  private:
    std::istringstream text_;
    orderlog::CommitForm form_;
};

Scene live_scene() {
    Scene scene = good_scene();
    scene.config.release = Release::once_placed;
    scene.config.maps = {MapFeed::both};
    return scene;
}

constexpr std::uint32_t kMapping = 1;

struct Recorded {
    std::string first_ot;
    std::string first_state;
    std::string last_ot;
    Saver saver;
};

/// Plays the scene and records from frame `begin` of the bus on, to frame `end`.
Recorded record(const Scene& scene, std::size_t begin, std::size_t end) {
    Pipeline pipeline = make_pipeline(scene);
    Recorded recorded;
    const std::vector<StampedFrame> frames = scene.bus.frames();
    auto depth = scene.depth.begin();
    for (std::size_t i = 0; i < end; ++i) {
        if (i == begin) {
            recorded.first_ot = encode_ot(pipeline.map());
            recorded.first_state = encode_snapshot(pipeline.builder().state(), {.mapping_crc32 = kMapping});
            pipeline.builder().for_each_joint_sample(
                [&](const JointMeasurement& joints) { recorded.saver.put(joints); });
            pipeline.set_listener(&recorded.saver);
        }
        pipeline.on_can(frames[i].frame, frames[i].stamp);
        while (depth != scene.depth.end() && pipeline.now() && depth->captured <= *pipeline.now()) {
            pipeline.on_depth(*depth++);
        }
    }
    recorded.last_ot = encode_ot(pipeline.map());
    return recorded;
}

MapBuilder make_builder(const Scene& scene, const std::string& first_state) {
    MapBuilder builder =
        MapBuilder::build(scene.rig, one_joint_robot(), scene.mapping, scene.config.joints, scene.config.maps)
            .value();
    auto first = decode_snapshot(first_state, scene.mapping, kMapping);
    EXPECT_TRUE(first) << first.error().what;
    EXPECT_EQ(builder.begin_with(std::move(first->state)), MapBuilder::LeftOut{});
    return builder;
}

/// The first frame of the bus that comes then or later.
std::size_t frame_at(const Scene& scene, double time_s) {
    const std::vector<StampedFrame> frames = scene.bus.frames();
    const std::int64_t from_ns = frames.front().stamp.ns + std::llround(time_s * 1e9);
    return static_cast<std::size_t>(std::ranges::count_if(
        frames, [from_ns](const StampedFrame& entry) { return entry.stamp.ns < from_ns; }));
}

void expect_live_map_from_any_moment_on(const Scene& scene) {
    for (const double begin_s : {0.0, 3.55, 3.99}) {
        const Recorded recorded = record(scene, frame_at(scene, begin_s), scene.bus.frames().size());
        MapBuilder builder = make_builder(scene, recorded.first_state);
        TextSource order(recorded.saver.text);
        ScriptedDepth depth(recorded.saver.frames);
        const OrderedOutcome outcome = replay_in_order(builder, order, {&depth});
        EXPECT_TRUE(outcome.took_all()) << "begun at " << begin_s << " s";
        EXPECT_TRUE(encode_ot(builder.map()) == recorded.last_ot) << "begun at " << begin_s << " s";
        EXPECT_GT(outcome.readings.used() + outcome.depth_frames.used(), 0U)
            << "begun at " << begin_s << " s";
        EXPECT_TRUE(recorded.first_ot != recorded.last_ot) << "begun at " << begin_s << " s";
    }
}

TEST(OrderedReplay, gives_the_live_map_byte_for_byte_from_any_moment_on) {
    Scene scene = live_scene();
    scene.depth.resize(1);  // at 4.0 s; each takes a while
    expect_live_map_from_any_moment_on(scene);
}

TEST(OrderedReplay, gives_the_live_map_where_sensors_see_a_cone) {
    Scene scene = live_scene();
    scene.depth.resize(1);
    scene.mapping.range_update = RangeUpdate::cone;
    for (HostNode& node : scene.rig.nodes) {
        for (HostSensor& sensor : node.sensors) sensor.zones.front().optics = {0.24, 0.12};
    }
    expect_live_map_from_any_moment_on(scene);
}

TEST(OrderedReplay, gives_the_live_map_where_a_saved_one_waits_for_its_first_measurement) {
    Scene scene = live_scene();
    scene.depth.clear();
    scene.mapping.map.age = {.stale_after_s = 10, .unknown_after_s = 12};
    Pipeline before = make_pipeline(scene);
    for (const StampedFrame& entry : scene.bus.frames()) before.on_can(entry.frame, entry.stamp);
    MapState saved = before.builder().state();
    ASSERT_GT(saved.map.known_voxels(), 0U);
    saved.map.begin_to_wait();
    Pipeline pipeline = make_pipeline(scene);
    EXPECT_EQ(pipeline.begin_with(std::move(saved)), MapBuilder::LeftOut{});
    pipeline.wait(4);
    const std::string first = encode_snapshot(pipeline.builder().state(), {.mapping_crc32 = kMapping});
    Saver saver;
    pipeline.set_listener(&saver);
    const auto expect_same = [&] {
        MapBuilder builder = make_builder(scene, first);
        TextSource order(saver.text);
        EXPECT_TRUE(replay_in_order(builder, order, {}).took_all());
        EXPECT_TRUE(encode_snapshot(builder.state(), {}) == encode_snapshot(pipeline.builder().state(), {}));
    };
    for (const std::int64_t seconds : {4, 5, 8, 11}) pipeline.wait(seconds);
    EXPECT_EQ(saver.text, "W 5\nW 8\nW 11\n");
    expect_same();
    for (const StampedFrame& entry : scene.bus.frames()) pipeline.on_can(entry.frame, entry.stamp);
    expect_same();
}

TEST(OrderedReplay, needs_the_first_map_and_the_joint_samples_before_it) {
    Scene scene = live_scene();
    scene.depth.clear();
    const std::size_t count = scene.bus.frames().size();
    const Recorded recorded = record(scene, frame_at(scene, 3.6), count);  // among the readings
    ASSERT_TRUE(recorded.first_ot != recorded.last_ot);
    const Recorded unrecorded = record(scene, 0, 1);
    MapBuilder without_map = make_builder(scene, unrecorded.first_state);
    TextSource order(recorded.saver.text);
    ScriptedDepth depth(recorded.saver.frames);
    EXPECT_TRUE(replay_in_order(without_map, order, {&depth}).took_all());
    EXPECT_TRUE(encode_ot(without_map.map()) != recorded.last_ot);
    MapBuilder without_past = make_builder(scene, recorded.first_state);
    const std::size_t first_committed = recorded.saver.text.find_first_of("RD");
    TextSource later(recorded.saver.text.substr(first_committed));
    ScriptedDepth again(recorded.saver.frames);
    EXPECT_FALSE(replay_in_order(without_past, later, {&again}).took_all());
}

TEST(OrderedReplay, begins_where_the_recording_does_and_not_with_the_joint_samples_of_before) {
    const Scene scene = live_scene();
    const std::string text = "J 1000000000 0\nJ 3010000000 0\nJ 3020000000 0\nR 1 0 0 3015000000 0.52 0.01\n";
    for (const auto& [reported, begin_ns] :
         {std::pair{std::optional<HostTime>(), 3'015'000'000},
          std::pair{std::optional(HostTime{3'012'000'000}), 3'012'000'000}}) {
        MapBuilder builder = make_builder(scene, record(scene, 0, 1).first_state);
        TextSource order(text);
        const OrderedOutcome outcome = replay_in_order(builder, order, {}, {}, reported);
        EXPECT_EQ(outcome.begin, HostTime{begin_ns});
        EXPECT_EQ(outcome.now, HostTime{3'015'000'000});
    }
}

/// Two cameras, one beside the other; their images are not of the same times.
Scene two_cameras(bool is_swapped) {
    Scene scene = live_scene();
    HostCamera left = scene.rig.cameras.front();
    HostCamera right = left;
    left.name = "left";
    right.name = "right";
    right.T_link_camera.translation().y() += 0.3;
    scene.rig.cameras = is_swapped ? std::vector{right, left} : std::vector{left, right};
    return scene;
}

/// Three images of each camera.
std::vector<DepthFrame> images_of(const std::string& camera) {
    std::vector<DepthFrame> frames;
    for (int k = 0; k < 3; ++k)
        frames.push_back(camera == "left" ? flat_frame(4.0 + 0.1 * k, 1500)
                                          : flat_frame(4.05 + 0.1 * k, 1300));
    return frames;
}

/// The map of a replay by capture time, the sources given in the order of the rig's cameras.
std::string replayed(const Scene& scene) {
    Pipeline pipeline = make_pipeline(scene);
    std::vector<ScriptedDepth> images;
    for (const HostCamera& camera : scene.rig.cameras) images.emplace_back(images_of(camera.name));
    ScriptedSource can(scene.bus.frames());
    EXPECT_TRUE(replay(pipeline, can, {&images[0], &images[1]}).is_complete());
    for (const auto& inputs : pipeline.inputs().depth_frames) EXPECT_EQ(inputs.used(), 3U);
    return encode_ot(pipeline.map());
}

TEST(OrderedReplay, by_capture_time_the_map_does_not_depend_on_the_order_of_the_cameras) {
    const std::string map = replayed(two_cameras(false));
    EXPECT_TRUE(map == replayed(two_cameras(true)));
    Scene alone = live_scene();
    alone.rig.cameras.front().name = "left";
    Pipeline pipeline = make_pipeline(alone);
    ScriptedDepth images(images_of("left"));
    ScriptedSource can(alone.bus.frames());
    EXPECT_TRUE(replay(pipeline, can, {&images}).is_complete());
    EXPECT_TRUE(map != encode_ot(pipeline.map())) << "the second camera makes a difference";
}

TEST(OrderedReplay, takes_each_cameras_frames_from_its_own_source) {
    std::string order_of_left;
    for (int ms = 3980; ms < 4200; ms += 10) order_of_left += "J " + std::to_string(ms) + "000000 1.5707\n";
    order_of_left += "D 0 0 4000000000\nD 1 0 4050000000\nD 0 1 4100000000\nD 1 1 4150000000\n";
    std::string order_of_right = order_of_left;
    for (std::size_t at = order_of_right.find("D "); at != std::string::npos;
         at = order_of_right.find("D ", at + 1))
        order_of_right[at + 2] = order_of_right[at + 2] == '0' ? '1' : '0';
    std::vector<std::string> maps;
    for (const bool is_swapped : {false, true}) {
        const Scene scene = two_cameras(is_swapped);
        MapBuilder builder = MapBuilder::build(scene.rig, one_joint_robot(), scene.mapping,
                                               scene.config.joints, scene.config.maps)
                                 .value();
        std::vector<ScriptedDepth> images;
        for (const HostCamera& camera : scene.rig.cameras) images.emplace_back(images_of(camera.name));
        TextSource order(is_swapped ? order_of_right : order_of_left, {.joints = kForm.joints, .cameras = 2});
        const OrderedOutcome outcome = replay_in_order(builder, order, {&images[0], &images[1]});
        EXPECT_TRUE(outcome.took_all());
        EXPECT_EQ(outcome.depth_frames.used(), 4U);
        maps.push_back(encode_ot(builder.map()));
    }
    EXPECT_TRUE(maps[0] == maps[1]);
    const Scene scene = two_cameras(false);
    MapBuilder builder =
        MapBuilder::build(scene.rig, one_joint_robot(), scene.mapping, scene.config.joints, scene.config.maps)
            .value();
    ScriptedDepth left(images_of("left"));
    TextSource order(order_of_left, {.joints = kForm.joints, .cameras = 2});
    EXPECT_EQ(replay_in_order(builder, order, {&left}).depth_missing, 2U) << "none are recorded of the other";
}

TEST(OrderedReplay, says_what_it_could_not_take) {
    const Scene scene = live_scene();
    MapBuilder builder = make_builder(scene, record(scene, 0, 1).first_state);
    TextSource order(
        "J 1000000000 0\nJ 1000000000 0\nJ 1010000000 0\n"  // the second is not later
        "R 77 0 0 1005000000 0.52 0.01\n"                   // no node of the rig
        "R 1 0 0 3005000000 0.52 0.01\n"                    // no joints about it
        "D 5 1005000000\nD - 1006000000\n");
    ScriptedDepth depth({flat_frame(1.0)});
    const OrderedOutcome outcome = replay_in_order(builder, order, {&depth});
    EXPECT_EQ(outcome.commits, 7U);
    EXPECT_EQ(outcome.joint_samples.rejected(JointReason::out_of_order), 1U);
    EXPECT_EQ(outcome.readings.rejected(ReadingReason::unknown_sensor), 1U);
    EXPECT_EQ(outcome.readings.rejected(ReadingReason::joints_missing), 1U);
    EXPECT_EQ(outcome.depth_missing, 2U);
    EXPECT_FALSE(outcome.took_all());
}

}  // namespace
}  // namespace octoskin
