// The scan before a replay and the replay itself must agree on whether a START counts.
#include "host/core/pipeline/start_scan.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/unit/host/core/pipeline/turning_scene.hpp"

namespace octoskin::test {
namespace {

StartScan scan(const Scene& scene) {
    StartScan result(scene.rig);
    for (const StampedFrame& entry : scene.bus.frames()) {
        result.on_frame(entry.frame, entry.stamp);
    }
    return result;
}

Scene with_mark(wire::MarkKind kind, double sent_s, double named_s, Scene scene = good_scene()) {
    scene.config.begin = MapBegin::start_mark;
    scene.bus.send(sent_s, wire::Mark{kind, static_cast<std::uint64_t>(host_at(named_s).ns / 1000)},
                   wire::kHostId);
    return scene;
}

/// The good scene without joints and ranges: a tenth of its frames.
Scene scene_without_measurements() {
    Scene scene;
    for (int k = 0; k <= 8; ++k) scene.bus.exchange(0.1 + k, {kLeft, kRight, kJoints});
    keep_alive(scene, kLeft);
    return scene;
}

/// Whether the pipeline itself begins there. Nothing is mapped: no image comes, and no map is written.
bool begins_with_start(const Scene& scene) {
    const PipelineInputs inputs = play(scene, scene.bus.frames()).inputs();
    return inputs.frames.rejected(FrameReason::mark_ignored) == 0;
}

TEST(StartScan, finds_a_start_exactly_where_the_pipeline_takes_it) {
    const Scene busy = good_scene();
    const Scene quiet = scene_without_measurements();
    int taken = 0;
    int ignored = 0;
    // Before the first exchange, while a bus runs, after its last exchange, after everything.
    for (const double sent_s : {0.01, 0.05, 0.101, 0.5, 3.0, 5.05, 8.95, 9.1}) {
        for (double apart_s = -8.0; apart_s <= 8.0; apart_s += 0.125) {
            if (sent_s + apart_s < 0.0) {
                continue;
            }
            const bool is_whole_second = std::fmod(apart_s, 1.0) == 0.0;
            const Scene scene =
                with_mark(wire::MarkKind::start, sent_s, sent_s + apart_s, is_whole_second ? busy : quiet);
            const bool is_taken = begins_with_start(scene);
            EXPECT_EQ(scan(scene).has_start(), is_taken) << sent_s << " " << apart_s;
            (is_taken ? taken : ignored) += 1;
        }
    }
    EXPECT_GT(taken, 50);
    EXPECT_GT(ignored, 50);
}

TEST(StartScan, tells_how_far_a_start_is_off_that_cannot_count) {
    for (const double apart_s : {-2.9, -1.5, 1.5, 2.9}) {
        const StartScan result = scan(with_mark(wire::MarkKind::start, 5.0, 5.0 + apart_s));
        EXPECT_FALSE(result.has_start());
        EXPECT_EQ(result.ignored().count, 1U);
        EXPECT_NEAR(1e-9 * static_cast<double>(result.ignored().ahead.count()), apart_s, 0.011);
    }
}

TEST(StartScan, finds_no_start_in_a_stop_or_in_no_mark) {
    EXPECT_FALSE(scan(with_mark(wire::MarkKind::stop, 5.0, 5.0)).has_start());
    EXPECT_FALSE(scan(good_scene()).has_start());
    EXPECT_EQ(scan(good_scene()).ignored().count, 0U);
}

TEST(StartScan, goes_on_to_a_later_start_that_counts) {
    Scene scene = with_mark(wire::MarkKind::start, 3.0, 5.0);
    scene.bus.send(3.4, wire::Mark{wire::MarkKind::start, 3'400'000}, wire::kHostId);
    EXPECT_TRUE(scan(scene).has_start());
    EXPECT_EQ(run(scene).inputs.readings.used(), 10U);
}

}  // namespace
}  // namespace octoskin::test
