// The true robot are meshes, the host has capsules fitted to them: the robot does not come into the map, and
// the scene beside it stays.
#include <gtest/gtest.h>

#include <cstdio>

#include "hw/sim/scenario/scenario.hpp"
#include "tests/sim/self_filter/mesh_robot.hpp"
#include "tests/support/own_arm/own_arm.hpp"

namespace octoskin {
namespace {

class MeshRobotTest : public testing::Test {
  protected:
    sim::World world_ =
        sim::World::read(
            sim::read_scenario(OCTOSKIN_SOURCE_DIR "/hw/worlds/experiment.scenario.yaml").value().world)
            .value();
    testing_support::OwnArm arm_;
    MeshRobot robot_{read_robot_text(arm_.urdf(), "").value(), {}, world_};
};

TEST_F(MeshRobotTest, is_removed_from_images_and_the_scene_beside_it_stays) {
    const MeshRobot::Pixels exact = robot_.filter(30, 0.0);
    std::printf(
        "%zu capsules: %zu of %zu robot pixels left; %zu of %zu scene pixels removed, %zu of them beyond the "
        "margin, the farthest at %.0f mm\n",
        robot_.capsule_count(), exact.robot_left, exact.of_robot, exact.scene_removed, exact.of_scene,
        exact.beyond_margin, 1e3 * exact.farthest_removed_m);
    EXPECT_GT(exact.of_robot, 50'000U);
    EXPECT_GT(exact.scene_removed, 100U);
    EXPECT_EQ(exact.robot_left, 0U);
    EXPECT_LE(exact.farthest_removed_m, robot_.rig().depth_self_margin_m + 0.03);
    // At 1 m/s: 2 cm.
    for (const double late_s : {0.02, -0.02}) {
        const MeshRobot::Pixels late = robot_.filter(30, late_s);
        EXPECT_LE(2000 * late.robot_left, late.of_robot) << late_s;
    }
}

TEST_F(MeshRobotTest, makes_no_voxel_occupied_for_longer_than_a_frame) {
    for (const double late_s : {0.02, -0.02})
        EXPECT_LE(robot_.frames_occupied(20, late_s, denoised_mapping()), 1U) << late_s;
}

}  // namespace
}  // namespace octoskin
