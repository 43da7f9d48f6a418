// Whose ranges are counted as a cone's: those of a sensor that sees one, where the mapping says so.
#include <gtest/gtest.h>

#include "host/core/pipeline/pipeline.hpp"
#include "tests/unit/host/core/pipeline/one_joint_scene.hpp"

namespace octoskin::test {
namespace {

Scene scene_of(RangeUpdate update, BeamOptics optics) {
    Scene scene = good_scene();
    scene.depth.resize(1);
    scene.mapping.range_update = update;
    for (HostNode& node : scene.rig.nodes) {
        for (HostSensor& sensor : node.sensors) sensor.zones.front().optics = optics;
    }
    return scene;
}

constexpr BeamOptics kCone{.half_angle_rad = 0.24, .sigma_rad = 0.12};

TEST(ConeWiring, changes_nothing_for_sensors_that_are_rays) {
    EXPECT_TRUE(run(scene_of(RangeUpdate::cone, {})).has_equal_maps(run(scene_of(RangeUpdate::ray, {}))));
}

TEST(ConeWiring, takes_a_cone_for_a_ray_where_the_mapping_says_so) {
    EXPECT_TRUE(run(scene_of(RangeUpdate::ray, kCone)).has_equal_maps(run(scene_of(RangeUpdate::ray, {}))));
}

TEST(ConeWiring, counts_in_the_maps_that_range_sensors_make_and_gives_the_same_bytes_each_time) {
    const Scene scene = scene_of(RangeUpdate::cone, kCone);
    const RunResult as_cone = run(scene);
    EXPECT_TRUE(as_cone.has_equal_maps(run(scene)));
    const RunResult as_ray = run(scene_of(RangeUpdate::ray, kCone));
    EXPECT_EQ(as_cone.depth_ot, as_ray.depth_ot);
    EXPECT_NE(as_cone.proximity_ot, as_ray.proximity_ot);
    EXPECT_NE(as_cone.fused_ot, as_ray.fused_ot);
    EXPECT_EQ(as_cone.accounts.readings.used(), as_ray.accounts.readings.used());
}

TEST(ConeWiring, counts_zones_with_parameters_of_their_own) {
    BeamOptics zone = kCone;
    zone.is_zone = true;
    Scene as_zone = scene_of(RangeUpdate::cone, zone);
    EXPECT_NE(run(as_zone).fused_ot, run(scene_of(RangeUpdate::cone, kCone)).fused_ot);
    as_zone.mapping.zone = as_zone.mapping.cone;
    EXPECT_TRUE(run(as_zone).has_equal_maps(run(scene_of(RangeUpdate::cone, kCone))));
}

}  // namespace
}  // namespace octoskin::test
