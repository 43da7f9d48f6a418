#include "host/apps/profile/rig_pipeline.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/host/core/pipeline/one_joint_scene.hpp"

namespace octoskin::test {
namespace {

using testing::HasSubstr;

TEST(RigPipeline, refuses_a_sensor_that_sees_more_voxels_than_one_reading_may_have) {
    HostRig rig = one_joint_rig();
    rig.nodes[0].sensors[0].zones[0].optics = {.half_angle_rad = M_PI / 4.0, .sigma_rad = M_PI / 4.0};
    MappingConfig mapping = plain_mapping();
    mapping.range_update = RangeUpdate::cone;
    EXPECT_TRUE(build_pipeline("a/rig.yaml", rig, one_joint_robot(), mapping, {}));
    mapping.map.resolution_m = 0.001;
    const auto refused = build_pipeline("a/rig.yaml", rig, one_joint_robot(), mapping, {});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().exit, ExitCode::bad_config);
    const Error& error = refused.error().error;
    EXPECT_EQ(error.code, ErrorCode::limit_exceeded);
    EXPECT_EQ(error.file, "a/rig.yaml");
    EXPECT_THAT(error.key, HasSubstr("sensor 0"));
    EXPECT_GT(std::stod(error.value), 16777216.0);
    for (const char* const part : {"45 degrees", "4 m", "range_limits.max_m", "0.001 m", "16777216"})
        EXPECT_THAT(error.what, HasSubstr(part));
    for (const char* const part : {"range_limits.max_m", "map.resolution_m", "half_angle_deg"})
        EXPECT_THAT(error.remedy, HasSubstr(part));
    mapping.range_update = RangeUpdate::ray;
    EXPECT_TRUE(build_pipeline("a/rig.yaml", rig, one_joint_robot(), mapping, {}));
}

TEST(RigPipeline, refuses_a_link_that_the_robot_does_not_have) {
    HostRig rig = one_joint_rig();
    rig.nodes[0].sensors[0].link = "tail";
    const auto refused = build_pipeline("a/rig.yaml", rig, one_joint_robot(), plain_mapping(), {});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().exit, ExitCode::bad_config);
    EXPECT_EQ(refused.error().error.code, ErrorCode::unknown_name);
    EXPECT_EQ(refused.error().error.file, "a/rig.yaml");
    EXPECT_EQ(refused.error().error.value, "'tail'");
}

}  // namespace
}  // namespace octoskin::test
