#include "tests/unit/host/core/pipeline/turning_scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace octoskin::test {

Eigen::Vector3d Shot::p_map() const {
    const double angle = captured_s - 5.5;
    return {0.02 + (0.12 + range_m) * std::cos(angle), 0.02 + (0.12 + range_m) * std::sin(angle), 0.02};
}

std::vector<Shot> shots() {
    std::vector<Shot> all;
    for (double t = 3.0; t < 7.9; t += 0.033) {
        const double golden = std::fmod(0.618 * static_cast<double>(all.size()), 1.0);
        all.push_back({t, 1e-3 * std::round(1e3 * (1.5 + 2.2 * golden))});
    }
    return all;
}

Scene turning_scene(wire::NodeId node, std::uint32_t offset_us) {
    Scene scene = good_scene();
    scene.depth.clear();
    scene.bus = ScriptedBus{};
    scene.bus.set_clock(node, offset_us);
    for (int k = 0; k <= 8; ++k) {
        scene.bus.exchange(0.1 + k, {kLeft, kJoints});
    }
    keep_alive(scene, kLeft);
    for (int k = 250; k <= 860; ++k) {
        const double position = 0.01 * k - 5.5;
        scene.bus.joints(0.01 * k, kJoints, {&position, 1});
    }
    for (const Shot& shot : shots()) {
        wire::RangeReading reading = good_reading();
        reading.range_mm = static_cast<std::uint16_t>(std::lround(1e3 * shot.range_m));
        scene.bus.range(shot.captured_s, kLeft, reading);
    }
    return scene;
}

Pipeline play(const Scene& scene, const std::vector<StampedFrame>& frames) {
    Pipeline pipeline = make_pipeline(scene);
    ScriptedSource source(frames);
    EXPECT_TRUE(replay(pipeline, source, {}).is_complete());
    EXPECT_TRUE(pipeline.is_balanced()) << pipeline.inputs_text();
    return pipeline;
}

void expect_hits_where_shots_ended(const Pipeline& pipeline, std::size_t hits_min) {
    const FusedMap& map = pipeline.map();
    std::size_t hits = 0;
    map.for_each_known([&](VoxelKey key, float log_odds) {
        if (log_odds <= 0.0F) {
            return;
        }
        ++hits;
        double nearest_m = 1e9;
        for (const Shot& shot : shots()) {
            nearest_m = std::min(nearest_m, (shot.p_map() - map.centre_of(key)).norm());
        }
        EXPECT_LT(nearest_m, 0.04);
    });
    EXPECT_GE(hits, hits_min);
}

}  // namespace octoskin::test
