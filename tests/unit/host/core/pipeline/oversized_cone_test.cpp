#include "host/core/pipeline/oversized_cone.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/host/core/pipeline/one_joint_scene.hpp"

namespace octoskin::test {
namespace {

constexpr BeamOptics kWide{.half_angle_rad = M_PI / 4.0, .sigma_rad = M_PI / 4.0};

MappingConfig mapping_of(double resolution_m) {
    MappingConfig mapping = plain_mapping();
    mapping.range_update = RangeUpdate::cone;
    mapping.map.resolution_m = resolution_m;
    return mapping;
}

HostRig rig_of(const BeamOptics& optics) {
    HostRig rig = one_joint_rig();
    rig.nodes[1].sensors[0].zones[0].optics = optics;
    rig.range_limits.max_m = 8.0;
    return rig;
}

TEST(OversizedCone, is_named_with_what_would_be_possible) {
    const auto found = find_oversized_cone(rig_of(kWide), mapping_of(0.001));
    ASSERT_TRUE(found);
    EXPECT_EQ(found->node, 1U);
    EXPECT_EQ(found->sensor, 0U);
    EXPECT_EQ(found->optics, kWide);
    EXPECT_TRUE(found->has_range);
    EXPECT_EQ(found->length_m, 8.0);
    EXPECT_GT(found->voxels, 1e11);
    EXPECT_GT(found->resolution_min_m, 0.02);
    EXPECT_LT(found->resolution_min_m, 0.03);
    EXPECT_FALSE(find_oversized_cone(rig_of(kWide), mapping_of(found->resolution_min_m)));
}

TEST(OversizedCone, may_be_one_without_return) {
    MappingConfig mapping = mapping_of(0.04);
    EXPECT_FALSE(find_oversized_cone(rig_of(kWide), mapping));
    mapping.no_return_clear_m = 100.0;
    const auto found = find_oversized_cone(rig_of(kWide), mapping);
    ASSERT_TRUE(found);
    EXPECT_FALSE(found->has_range);
    EXPECT_EQ(found->length_m, 100.0);
    mapping.map.resolution_m = found->resolution_min_m;
    EXPECT_FALSE(find_oversized_cone(rig_of(kWide), mapping));
}

TEST(OversizedCone, may_be_one_that_marks_where_longer_ones_do_not) {
    MappingConfig mapping = mapping_of(0.01);
    mapping.cone.hit_range_max_m = 2.0;
    const BeamOptics of_narrow_core{.half_angle_rad = M_PI / 4.0, .sigma_rad = 0.01};
    const auto found = find_oversized_cone(rig_of(of_narrow_core), mapping);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->length_m, 2.0);
}

TEST(OversizedCone, is_none_where_all_sensors_are_rays) {
    MappingConfig mapping = mapping_of(0.001);
    EXPECT_FALSE(find_oversized_cone(rig_of({}), mapping));
    mapping.range_update = RangeUpdate::ray;
    EXPECT_FALSE(find_oversized_cone(rig_of(kWide), mapping));
}

}  // namespace
}  // namespace octoskin::test
