#include "host/core/pipeline/replay.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "tests/unit/host/core/pipeline/one_joint_scene.hpp"

namespace octoskin {
namespace {

using namespace test;

/// Gives what another source gives, and then fails.
class FailingCan final : public CanSource {
  public:
    explicit FailingCan(std::vector<StampedFrame> frames) : good_(std::move(frames)) {}
    [[nodiscard]] Result<std::optional<StampedFrame>, Error> next() override {
        auto frame = good_.next();
        if (!*frame) {
            return unexpected(Error{ErrorCode::system_error, "reading failed after line 3433"});
        }
        return frame;
    }

  private:
    ScriptedSource good_;
};
class FailingDepth final : public DepthSource {
  public:
    explicit FailingDepth(std::vector<DepthFrame> frames) : good_(std::move(frames)) {}
    [[nodiscard]] Result<std::optional<DepthFrame>, Error> next() override {
        auto frame = good_.next();
        if (!*frame) {
            return unexpected(Error{ErrorCode::damaged, "ends within frame 6"});
        }
        return frame;
    }

  private:
    ScriptedDepth good_;
};

TEST(Replay, gives_each_depth_frame_in_when_the_log_has_come_to_its_capture_time) {
    const Scene scene = good_scene();
    Pipeline pipeline = make_pipeline(scene);
    // Refused as late, or as ahead of time, if they came all at the end or all at the beginning.
    ScriptedSource can(scene.bus.frames());
    ScriptedDepth depth({flat_frame(0.2), flat_frame(4.0), flat_frame(8.9)});
    EXPECT_TRUE(replay(pipeline, can, {&depth}).is_complete());
    EXPECT_EQ(pipeline.inputs().depth_frames.front().rejected(DepthReason::joints_missing), 1U)
        << "no clock at 0.2 s";
    EXPECT_EQ(pipeline.inputs().depth_frames.front().used(), 2U);
    EXPECT_TRUE(pipeline.is_balanced());
}

TEST(Replay, reports_its_progress_every_1000_frames_and_at_the_end) {
    const Scene scene = good_scene();
    Pipeline pipeline = make_pipeline(scene);
    ScriptedSource can(scene.bus.frames());
    ScriptedDepth depth(scene.depth);
    std::vector<std::uint64_t> frames;
    ReplayProgress last;
    const ReplayOutcome outcome = replay(pipeline, can, {&depth}, [&](const ReplayProgress& progress) {
        frames.push_back(progress.can_frames);
        last = progress;
    });
    EXPECT_EQ(frames, (std::vector<std::uint64_t>{1000, 2000, 3000, 3487}));
    EXPECT_EQ(last.depth_frames, 6U);
    EXPECT_EQ(last.begin, host_at(0.0))
        << "the first frame, though the FOLLOW_UP that dates it came at 0.101";
    EXPECT_EQ(last.now, host_at(9.0004)) << "the last joint frame";
    EXPECT_EQ(outcome.progress.can_frames, 3487U);
}

TEST(Replay, uses_what_a_source_gave_before_it_failed_and_says_why_it_did) {
    const Scene scene = good_scene();
    Pipeline pipeline = make_pipeline(scene);
    FailingCan can(scene.bus.frames());
    FailingDepth depth(scene.depth);
    const ReplayOutcome outcome = replay(pipeline, can, {&depth});
    EXPECT_FALSE(outcome.is_complete());
    EXPECT_EQ(outcome.can_error.value().code, ErrorCode::system_error);
    EXPECT_EQ(outcome.can_error.value().what, "reading failed after line 3433");
    EXPECT_EQ(outcome.depth_errors.at(0).code, ErrorCode::damaged);
    EXPECT_EQ(outcome.depth_errors.at(0).what, "ends within frame 6");
    EXPECT_EQ(pipeline.inputs().readings.used(), 10U);
    EXPECT_EQ(pipeline.inputs().depth_frames.front().used(), 6U);
    EXPECT_TRUE(pipeline.is_balanced());
}

TEST(Replay, needs_no_depth_source) {
    const Scene scene = good_scene();
    Pipeline pipeline = make_pipeline(scene);
    ScriptedSource can(scene.bus.frames());
    EXPECT_TRUE(replay(pipeline, can, {}).is_complete());
    EXPECT_EQ(pipeline.inputs().readings.used(), 10U);
}

TEST(Replay, of_a_log_twice_in_succession_gives_the_map_of_once) {
    const Scene scene = good_scene();
    const RunResult once = run(scene);
    std::vector<StampedFrame> twice = scene.bus.frames();
    for (const StampedFrame& entry : scene.bus.frames()) {
        twice.push_back(entry);
    }
    const RunResult result = run(scene, twice);
    EXPECT_TRUE(result.has_equal_maps(once));
    EXPECT_EQ(result.inputs.readings.in(), 20U);
    EXPECT_EQ(result.inputs.readings.used(), 10U);
}

TEST(Replay, of_the_last_reading_again_with_a_new_clock_map_uses_it_once) {
    // The bus falls silent while the last reading waits; it comes again, some of it at the same instant.
    const Scene scene = good_scene();
    const RunResult once = run(scene);
    for (const double end_s : {3.82, 3.9, 4.06, 4.2}) {
        std::vector<StampedFrame> twice;
        for (const StampedFrame& entry : scene.bus.frames()) {
            if (entry.stamp < wall_at(end_s)) {
                twice.push_back(entry);
            }
        }
        for (const StampedFrame& entry : scene.bus.frames()) {
            twice.push_back(entry);
        }
        EXPECT_EQ(run(scene, twice).proximity_ot, once.proximity_ot) << end_s;
        EXPECT_EQ(run(scene, twice).inputs.readings.used(), 10U) << end_s;
    }
}

TEST(Replay, loses_no_frame_of_a_camera_that_outlives_the_bus) {
    Scene scene = good_scene();
    scene.mapping.removes_robot_from_depth = true;
    scene.depth.clear();
    for (int k = 0; k < 79; ++k) {  // 7.4 to 10.0 s, at 30 Hz
        scene.depth.push_back(flat_frame(7.4 + k / 30.0));
    }
    const RunResult result = run(scene);
    EXPECT_EQ(result.inputs.depth_frames.front().rejected(DepthReason::queue_overflow), 0U)
        << result.inputs_text;
    // Joints end at 9.0 s: 49 frames until then.
    EXPECT_EQ(result.inputs.depth_frames.front().used(), 49U) << result.inputs_text;
    EXPECT_EQ(result.inputs.depth_frames.front().used() +
                  result.inputs.depth_frames.front().rejected(DepthReason::joints_missing),
              79U);
}

TEST(Replay, ignores_marks_far_from_now) {
    Scene scene = good_scene();
    scene.config.begin = MapBegin::start_mark;
    scene.bus.send(3.45, wire::Mark{wire::MarkKind::start, 3'450'000}, wire::kHostId);
    const RunResult expected = run(scene);
    EXPECT_EQ(expected.inputs.readings.used(), 10U);
    for (const auto kind : {wire::MarkKind::start, wire::MarkKind::stop}) {
        for (const std::uint64_t at_us :
             {std::uint64_t{0}, std::uint64_t{10'000'000}, (std::uint64_t{1} << 48) - 1}) {
            for (const double sent_s : {0.05, 3.4, 3.55}) {  // at 0.05 s "now" is not known yet
                Scene damaged = scene;
                damaged.bus.send(sent_s, wire::Mark{kind, at_us}, wire::kHostId);
                if (at_us == 0 && sent_s < 1.0) {
                    continue;  // that is its time
                }
                const RunResult result = run(damaged);
                EXPECT_TRUE(result.has_equal_maps(expected)) << at_us << " at " << sent_s;
                EXPECT_EQ(result.inputs.frames.rejected(FrameReason::mark_ignored), 1U);
            }
        }
    }
}

TEST(Replay, keeps_a_mark_until_the_time_is_known) {
    Scene scene = good_scene();
    scene.config.begin = MapBegin::start_mark;
    scene.bus.send(0.05, wire::Mark{wire::MarkKind::start, 50'000}, wire::kHostId);
    EXPECT_EQ(run(scene).inputs.readings.used(), 10U);
}

TEST(Replay, maps_from_start_to_stop_if_told_so) {
    Scene scene = good_scene();
    scene.config.begin = MapBegin::start_mark;
    // Good readings: 3.505, 3.538, 3.571, 3.604, ...; depth frames at 4.0, 4.1, ...
    scene.bus.send(3.6, wire::Mark{wire::MarkKind::start, 3'530'000}, wire::kHostId);
    scene.bus.send(4.2, wire::Mark{wire::MarkKind::stop, 4'100'000}, wire::kHostId);
    const RunResult result = run(scene);
    EXPECT_EQ(result.inputs.readings.rejected(ReadingReason::outside_marks), 1U);
    EXPECT_EQ(result.inputs.readings.used(), 9U);
    EXPECT_EQ(result.inputs.depth_frames.front().rejected(DepthReason::outside_marks), 4U);
    EXPECT_EQ(result.inputs.depth_frames.front().used(), 2U);
}

}  // namespace
}  // namespace octoskin
