// A live map with a worker for depth frames: readings do not wait for an image.
#include <gtest/gtest.h>

#include <new>
#include <stdexcept>

#include "host/core/pipeline/ordered_replay.hpp"
#include "host/core/pipeline/pipeline.hpp"
#include "host/io/mapfile/octomap_writer.hpp"
#include "tests/unit/host/core/pipeline/one_joint_scene.hpp"
#include "tests/unit/host/core/pipeline/patient_worker.hpp"

namespace octoskin {
namespace {

using namespace test;

/// Readings every 20 ms beside the images, from 4 s to 4.6 s.
Scene busy_scene() {
    Scene scene = good_scene();
    scene.config.release = Release::once_placed;
    for (int k = 0; k < 30; ++k) scene.bus.range(4.005 + 0.02 * k, kLeft, good_reading(kSpare));
    return scene;
}

/// Gives all to a pipeline with this worker, which ends `patience` frames of the bus after it began.
Pipeline play(const Scene& scene, Pipeline pipeline, PatientWorker& worker, int patience) {
    auto depth = scene.depth.begin();
    int begun = 0;
    int since = 0;
    for (const StampedFrame& entry : scene.bus.frames()) {
        pipeline.on_can(entry.frame, entry.stamp);
        while (depth != scene.depth.end() && pipeline.now() && depth->captured <= *pipeline.now()) {
            pipeline.on_depth(*depth++);
        }
        since = worker.begun > begun ? 0 : since + 1;
        begun = worker.begun;
        if (since == patience) {
            worker.end();
            pipeline.on_worker_done();
        }
        EXPECT_TRUE(pipeline.is_balanced()) << pipeline.inputs_text();
    }
    pipeline.finish();
    EXPECT_TRUE(pipeline.is_balanced()) << pipeline.inputs_text();
    return pipeline;
}

constexpr int kNeverDone = 1'000'000;

class DepthWorkerTest : public testing::TestWithParam<int> {};

TEST_P(DepthWorkerTest, loses_nothing_and_the_order_told_makes_the_same_map_however_long_an_image_takes) {
    const Scene scene = busy_scene();
    PatientWorker worker;
    CommitOrder order;
    Pipeline made = make_pipeline(scene);
    made.set_listener(&order);
    made.work_beside({&worker});
    // The pipeline is moved before anything is given to it.
    const Pipeline pipeline = play(scene, std::move(made), worker, GetParam());
    const auto& frames = pipeline.inputs().depth_frames.front();
    EXPECT_EQ(frames.used() + frames.rejected(DepthReason::queue_overflow), 6U) << pipeline.inputs_text();
    EXPECT_EQ(frames.used(), static_cast<std::uint64_t>(worker.begun));
    if (GetParam() <= 7) {
        EXPECT_EQ(frames.used(), 6U) << "it is quick enough";
    } else if (GetParam() == kNeverDone) {
        EXPECT_EQ(frames.used(), 1U) << "the first, at the end";
    }
    EXPECT_EQ(pipeline.inputs().readings.used(), 40U) << pipeline.inputs_text();

    Pipeline replayed = make_pipeline(scene);
    ScriptedDepth depth(order.frames());
    const OrderedOutcome outcome = replay_in_order(replayed.builder(), order, {&depth});
    EXPECT_EQ(outcome.depth_frames.used(), frames.used());
    EXPECT_EQ(encode_ot(replayed.map()), encode_ot(pipeline.map()));
    EXPECT_EQ(encode_ot(replayed.map(MapFeed::camera)), encode_ot(pipeline.map(MapFeed::camera)));
}

INSTANTIATE_TEST_SUITE_P(Patience, DepthWorkerTest, testing::Values(1, 2, 7, 20, 40, kNeverDone));

TEST(DepthWorker, lets_readings_go_into_the_map_while_it_works) {
    const Scene scene = busy_scene();
    PatientWorker worker;
    Pipeline pipeline = make_pipeline(scene);
    pipeline.work_beside({&worker});
    auto depth = scene.depth.begin();
    std::uint64_t used_at_begin = 0;
    for (const StampedFrame& entry : scene.bus.frames()) {
        pipeline.on_can(entry.frame, entry.stamp);
        while (depth != scene.depth.end() && pipeline.now() && depth->captured <= *pipeline.now()) {
            pipeline.on_depth(*depth++);
        }
        if (worker.begun == 0) used_at_begin = pipeline.inputs().readings.used();
    }
    EXPECT_EQ(worker.begun, 1) << "the others wait for the first";
    EXPECT_EQ(pipeline.inputs().depth_frames.front().rejected(DepthReason::queue_overflow), 3U) << "but two";
    EXPECT_GE(pipeline.inputs().readings.used(), used_at_begin + 30);
    EXPECT_EQ(pipeline.inputs().depth_frames.front().used(), 0U);
    pipeline.on_worker_done();
    EXPECT_EQ(pipeline.inputs().depth_frames.front().used(), 0U) << "it is not done";
    EXPECT_EQ(worker.waits, 0);
    worker.end();
    pipeline.on_worker_done();
    EXPECT_EQ(pipeline.inputs().depth_frames.front().used(), 1U);
    EXPECT_EQ(worker.begun, 2);
    pipeline.finish();
    EXPECT_EQ(pipeline.inputs().depth_frames.front().used(), 2U);
    EXPECT_EQ(worker.waits, 1) << "for the one that it was at, and no other";
    EXPECT_TRUE(pipeline.is_balanced()) << pipeline.inputs_text();
}

TEST(DepthWorker, is_not_given_a_frame_that_cannot_be_placed) {
    Scene scene = busy_scene();
    scene.depth = {flat_frame(7.15)};  // no joints between 7.0 and 7.3 s
    PatientWorker worker;
    Pipeline made = make_pipeline(scene);
    made.work_beside({&worker});
    const Pipeline pipeline = play(scene, std::move(made), worker, 1);
    EXPECT_EQ(worker.begun, 0);
    EXPECT_EQ(pipeline.inputs().depth_frames.front().rejected(DepthReason::joints_missing), 1U);
}

TEST(DepthWorker, s_frame_is_not_used_once_the_pose_that_a_replay_needs_is_forgotten) {
    Scene scene = busy_scene();
    scene.config.joints.capacity = 20;  // 0.2 s
    scene.depth = {flat_frame(4.0)};
    for (const int patience : {5, 300}) {
        PatientWorker worker;
        CommitOrder order;
        Pipeline made = make_pipeline(scene);
        made.set_listener(&order);
        made.work_beside({&worker});
        const Pipeline pipeline = play(scene, std::move(made), worker, patience);
        const auto& frames = pipeline.inputs().depth_frames.front();
        EXPECT_EQ(frames.used(), patience == 5 ? 1U : 0U) << pipeline.inputs_text();
        EXPECT_EQ(frames.rejected(DepthReason::late), patience == 5 ? 0U : 1U) << pipeline.inputs_text();
        EXPECT_EQ(order.frames().size(), frames.used());
    }
}

TEST(DepthWorker, s_refusal_is_counted) {
    Scene scene = busy_scene();
    scene.depth = {flat_frame(4.0)};
    scene.depth.front().width += 1;
    PatientWorker worker;
    Pipeline made = make_pipeline(scene);
    made.work_beside({&worker});
    const Pipeline pipeline = play(scene, std::move(made), worker, 3);
    EXPECT_EQ(worker.begun, 1);
    EXPECT_EQ(pipeline.inputs().depth_frames.front().rejected(DepthReason::wrong_size), 1U);
}

/// The first `refusals` pieces of work find no memory to begin with.
class PoorWorker final : public DepthWorker {
  public:
    void begin(std::function<void()> work) override {
        if (refusals-- > 0) throw std::bad_alloc();
        worker_.begin(std::move(work));
        worker_.end();
    }
    bool is_done() const override { return worker_.is_done(); }
    void finish() override { worker_.finish(); }
    int refusals = 2;

  private:
    PatientWorker worker_;
};

TEST(DepthWorker, that_finds_no_memory_costs_its_frame_and_no_other) {
    Scene scene = busy_scene();
    ASSERT_GT(scene.depth.size(), 3U);
    PoorWorker worker;
    Pipeline pipeline = make_pipeline(scene);
    pipeline.work_beside({&worker});
    std::size_t next = 0;
    for (const StampedFrame& entry : scene.bus.frames()) {
        pipeline.on_can(entry.frame, entry.stamp);
        if (worker.is_done()) pipeline.on_worker_done();
        for (; next < scene.depth.size() && pipeline.now() && scene.depth[next].captured <= *pipeline.now();
             ++next)
            pipeline.on_depth(scene.depth[next]);
    }
    pipeline.finish();
    const auto& frames = pipeline.inputs().depth_frames.front();
    EXPECT_EQ(frames.rejected(DepthReason::no_memory), 2U) << pipeline.inputs_text();
    EXPECT_EQ(frames.used(), next - 2U) << pipeline.inputs_text();
    EXPECT_TRUE(pipeline.is_balanced()) << pipeline.inputs_text();
}

}  // namespace
}  // namespace octoskin
