// That the witness is told of what goes into the map, and of the image as it went in.
#include <gtest/gtest.h>

#include <cmath>

#include "host/core/pipeline/map_builder.hpp"
#include "tests/unit/host/core/pipeline/one_joint_scene.hpp"

namespace octoskin::test {
namespace {

/// The arm turns by 2.3 degrees from image to image; its sensor reports 0.52 m each time, and the camera sees
/// this far.
SensorEvidence after_six_images(const MappingConfig& mapping, std::uint16_t depth_mm, bool goes_back) {
    HostRig rig = one_joint_rig();
    rig.camera->intrinsics.fx = 10.0;
    rig.camera->intrinsics.fy = 10.0;
    auto builder = MapBuilder::build(rig, one_joint_robot(), mapping, {}, {}).value();
    for (int i = 0; i < 6; ++i) {
        const HostTime now = host_at(1.0 + 0.1 * i);
        EXPECT_TRUE(builder.add({now, {M_PI / 2.0 - 0.04 * i}}));
        EXPECT_TRUE(builder.integrate(RangeMeasurement{{kLeft, kGood, 0}, now, 0.52, 0.02}));
        if (goes_back) {
            builder.forget_motion({});
            EXPECT_TRUE(builder.add({now, {M_PI / 2.0 - 0.04 * i}}));
        }
        EXPECT_TRUE(builder.integrate(flat_frame(1.0 + 0.1 * i, depth_mm)));
    }
    return builder.witness()->evidence(kLeft, kGood);
}

TEST(Witness, flags_a_sensor_whose_ranges_end_where_the_camera_sees_through) {
    const SensorEvidence evidence = after_six_images(plain_mapping(), 3'000, false);
    EXPECT_EQ(evidence.in_free_space, 6U);
    EXPECT_TRUE(evidence.contradicts);
}

TEST(Witness, has_nothing_to_say_of_readings_of_a_time_that_is_over) {
    EXPECT_EQ(after_six_images(plain_mapping(), 3'000, true).in_free_space, 0U);
}

TEST(Witness, is_not_there_without_a_camera_or_where_the_robot_stays_in_the_image) {
    HostRig rig = one_joint_rig();
    MappingConfig mapping = plain_mapping();
    mapping.removes_robot_from_depth = false;
    EXPECT_EQ(MapBuilder::build(rig, one_joint_robot(), mapping, {}, {}).value().witness(), nullptr);
    rig.camera.reset();
    EXPECT_EQ(MapBuilder::build(rig, one_joint_robot(), plain_mapping(), {}, {}).value().witness(), nullptr);
}

// The camera looks at the arm, which points at the camera, and its sensor with it: half a metre before the
// arm there is nothing, for the camera sees the arm behind that. In the map the arm's pixels are none.
TEST(Witness, sees_through_in_front_of_the_robot) {
    HostRig rig = one_joint_rig();
    rig.camera->intrinsics = {.width = 20, .height = 20, .fx = 40.0, .fy = 40.0, .cx = 10.0, .cy = 10.0};
    rig.camera->T_base_camera.translation().z() = 0.0;
    auto builder = MapBuilder::build(rig, one_joint_robot(), plain_mapping(), {}, {}).value();
    const HostTime now = host_at(1.0);
    ASSERT_TRUE(builder.add({now, {0.0}}));
    ASSERT_TRUE(builder.integrate(RangeMeasurement{{kLeft, kGood, 0}, now, 0.5, 0.02}));
    ASSERT_TRUE(builder.integrate(DepthFrame{now, 20, 20, std::vector<std::uint16_t>(400, 1'840)}));
    EXPECT_GT(builder.depth_stage()->robot_pixels(), 10U);
    EXPECT_EQ(builder.witness()->evidence(kLeft, kGood).in_free_space, 1U);
}

}  // namespace
}  // namespace octoskin::test
