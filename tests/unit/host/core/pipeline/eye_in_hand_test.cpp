// A camera on a link of the arm: each image has the pose of its own time.
#include <gtest/gtest.h>

#include "host/io/mapfile/octomap_writer.hpp"
#include "tests/unit/host/core/pipeline/one_joint_scene.hpp"

namespace octoskin {
namespace {

using namespace test;

Eigen::Isometry3d T_base_arm(double t_s) {
    return Eigen::Isometry3d(Eigen::AngleAxisd(angle_at(t_s), Eigen::Vector3d::UnitZ()));
}

/// The scene without readings, and two images before and after the arm has turned.
Scene scene_of_images() {
    Scene scene = good_scene();
    scene.depth = {flat_frame(3.3, 700), flat_frame(4.0, 900)};
    return scene;
}

/// At the end of the arm, looking outward.
Eigen::Isometry3d T_arm_camera() {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.translation() = Eigen::Vector3d(0.2, 0.01, 0.03);
    T.linear().col(0) = -Eigen::Vector3d::UnitY();
    T.linear().col(1) = -Eigen::Vector3d::UnitZ();
    T.linear().col(2) = Eigen::Vector3d::UnitX();
    return T;
}

std::string camera_map(const Scene& scene) {
    const RunResult result = run(scene);
    EXPECT_EQ(result.inputs.depth_frames.front().used(), 2U) << result.inputs_text;
    return result.depth_ot;
}

// The oracle is a data set's camera, whose pose comes with each image.
TEST(EyeInHand, makes_the_map_of_a_camera_whose_poses_are_given) {
    Scene on_arm = scene_of_images();
    on_arm.rig.cameras.front().link = "arm";
    on_arm.rig.cameras.front().T_link_camera = T_arm_camera();
    Scene given = scene_of_images();
    for (DepthFrame& frame : given.depth)
        frame.T_map_camera =
            given.rig.T_map_base * T_base_arm(1e-9 * static_cast<double>(frame.captured.ns)) * T_arm_camera();
    const std::string map = camera_map(on_arm);
    EXPECT_EQ(map, camera_map(given));
    Scene rest = scene_of_images();
    rest.rig.cameras.front().T_link_camera = T_arm_camera();
    EXPECT_NE(map, camera_map(rest)) << "the arm has turned";
}

TEST(EyeInHand, does_not_see_without_joint_states) {
    Scene scene = scene_of_images();
    scene.rig.cameras.front().link = "arm";
    scene.depth = {flat_frame(7.15)};  // within the gap of the joint states
    const RunResult result = run(scene);
    EXPECT_EQ(result.inputs.depth_frames.front().rejected(DepthReason::joints_missing), 1U)
        << result.inputs_text;
}

TEST(EyeInHand, is_refused_on_a_link_that_the_robot_does_not_have) {
    Scene scene = scene_of_images();
    scene.rig.cameras.front().link = "antenna";
    const auto pipeline = Pipeline::build(scene.rig, one_joint_robot(), scene.mapping, scene.config);
    ASSERT_FALSE(pipeline);
    EXPECT_EQ(pipeline.error().error, RobotModelError::unreachable);
    EXPECT_EQ(pipeline.error().element, "antenna");
}

}  // namespace
}  // namespace octoskin
