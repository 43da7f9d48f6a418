// What a range sensor on the experiment's moving arm sees. Oracle: distances worked out by hand from the
// scene's and the circle's numbers.
#include "hw/sim/camera/sensor_scene.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/hw/sim/camera/experiment_sensor.hpp"

namespace octoskin::sim {
namespace {

constexpr double kHalfTurn = 3.14159265358979323846;

TEST_F(ExperimentSensor, looking_down_sees_the_floor_from_where_the_arm_is_at_that_instant) {
    const auto down = scene(Eigen::Isometry3d::Identity());
    // The flange is 0.45 + 0.3 sin a above the base, the floor 0.02 below it.
    EXPECT_NEAR(*down(0, {0}, Roi{}).range_m, 0.47, 1e-6);
    EXPECT_NEAR(*down(1, kStart, Roi{}).range_m, 0.47, 1e-6);
    EXPECT_NEAR(*down(2, {5'500'000}, Roi{}).range_m, 0.77, 1e-6);
    EXPECT_NEAR(*down(3, {10'500'000}, Roi{}).range_m, 0.17, 1e-6);
    EXPECT_NEAR(*down(4, {3'833'333}, Roi{}).range_m, 0.47 + 0.15, 2e-6);  // 30 degrees in
}

TEST_F(ExperimentSensor, looking_ahead_sees_the_panel) {
    EXPECT_NEAR(*scene(looking({1, 0, 0}))(0, {0}, Roi{}).range_m, 1.165 - 0.45, 1e-6);
}

TEST_F(ExperimentSensor, a_mesh_of_the_robot_is_seen_as_the_same_solid_of_the_world) {
    const World floor(std::vector<Solid>{box_at({10, 10, 0.1}, {0, 0, -0.07})});
    const Solid panel = box_at({0.03, 0.845, 1.0}, {1.18, 0.5075, 0.48});
    const Body body(expect_read(rig::read_capsules(kHw / "robots/panda.urdf", {})),
                    {{"panda_link0", {panel.vertices, panel.triangles}}});
    const SensorSurroundings of_world = surroundings(0.01, 3);
    const SensorSurroundings of_body{.world = floor,
                                     .arm = arm_,
                                     .trajectory = trajectory_,
                                     .body = body,
                                     .ignored_links = kMount,
                                     .optics = of_world.optics,
                                     .seed = of_world.seed};
    for (const auto& cone : {std::optional<rig::Cone>(), std::optional(rig::Cone{})}) {
        const SensorMount mount{"panda_link8", looking({1, 0.3, 0}), 0, cone};
        const auto expected = ranging_scene(of_world, mount);
        const auto found = ranging_scene(of_body, mount);
        for (std::uint32_t i = 0; i < 50; ++i) {
            const SimTime time{200'000 * std::int64_t{i}};
            const auto in_world = expected(i, time, Roi{});
            const auto of_robot = found(i, time, Roi{});
            ASSERT_EQ(in_world.range_m.has_value(), of_robot.range_m.has_value()) << i;
            EXPECT_NEAR(of_robot.range_m.value_or(0.0), in_world.range_m.value_or(0.0), 1e-4) << i;
            EXPECT_NEAR(of_robot.peak_signal_mcps, in_world.peak_signal_mcps, 1e-2) << i;
        }
    }
}

TEST_F(ExperimentSensor, looking_into_the_open_gets_no_return) {
    const auto seen = scene(looking({0, -1, 0}))(0, {0}, Roi{});
    EXPECT_FALSE(seen.range_m);
}

TEST_F(ExperimentSensor, looking_back_along_the_arm_sees_the_arm_but_not_its_own_mount) {
    // From beside the flange straight up past link 7 (radius 0.055): link 6's capsule lies 0.107 above,
    // between frames 6 and 7, radius 0.06. Beneath its axis, 0.05 m aside along the link's y, it is reached
    // at 0.107 - sqrt(0.06^2 - 0.05^2). With one metre out of the way there is nothing above.
    Eigen::Isometry3d beside = looking({0, 0, -1});
    beside.translation() << 0.0, 0.05, 0.0;
    const auto seen = scene(beside)(0, {0}, Roi{});
    ASSERT_TRUE(seen.range_m);
    // Link 6 reaches the flange's axis at its end, so straight along it the sensor meets the end's sphere
    // first.
    const Eigen::Isometry3d T_base_flange = arm_.forward(trajectory_.at({0}), "panda_link8");
    const Eigen::Isometry3d T_base_link6 = arm_.forward(trajectory_.at({0}), "panda_link6");
    const Eigen::Vector3d p_base_end = T_base_link6 * Eigen::Vector3d(0.088, 0, 0);
    EXPECT_NEAR((T_base_flange.inverse() * p_base_end - Eigen::Vector3d(0, 0, -0.107)).norm(), 0.0, 1e-12);
    EXPECT_LE(*seen.range_m, 0.107 - std::sqrt(0.06 * 0.06 - 0.05 * 0.05) + 1e-9);
    EXPECT_GE(*seen.range_m, 0.107 - 0.06);
    beside.translation() << 0.0, 1.0, 0.0;
    EXPECT_FALSE(scene(beside)(0, {0}, Roi{}).range_m);
}

TEST_F(ExperimentSensor, sees_nothing_nearer_or_further_than_its_optics_allow) {
    // Moved along its own axis to 3.9 cm and 4.1 cm above the floor.
    Eigen::Isometry3d near = Eigen::Isometry3d::Identity();
    near.translation().z() = 0.47 - 0.039;
    EXPECT_FALSE(scene(near)(0, {0}, Roi{}).range_m);
    near.translation().z() = 0.47 - 0.041;
    EXPECT_TRUE(scene(near)(0, {0}, Roi{}).range_m);
    Eigen::Isometry3d far = Eigen::Isometry3d::Identity();
    far.translation() << 0.0, -2.0, 0.47 - 4.01;  // away from the arm
    EXPECT_FALSE(scene(far)(0, {0}, Roi{}).range_m);
    far.translation().z() = 0.47 - 3.99;
    EXPECT_TRUE(scene(far)(0, {0}, Roi{}).range_m);
}

TEST_F(ExperimentSensor, looks_where_the_middle_of_its_zone_looks) {
    // The lower right quarter of the array (UM2555's table), centre 60 of a 8 x 8 zone: the lens inverts, so
    // it looks up and to the left by the same angle; the floor is 1 / cos further away.
    const auto down = scene(Eigen::Isometry3d::Identity());
    const Roi corner{.centre_spad = 28, .width = 8, .height = 8};
    const double per_spad = 27.0 / (16.0 * std::sqrt(2.0)) * kHalfTurn / 180.0;
    const double tangent = std::tan(4.0 * per_spad);
    EXPECT_NEAR(*down(0, {0}, corner).range_m, 0.47 * std::sqrt(1.0 + 2.0 * tangent * tangent), 1e-6);
}

TEST_F(ExperimentSensor, has_gaussian_noise_of_its_own_by_ranging_index) {
    const auto noisy = scene(Eigen::Isometry3d::Identity(), 0.02, 9, 5);
    double sum = 0.0, squares = 0.0;
    constexpr int kDraws = 20'000;
    for (std::uint32_t i = 0; i < kDraws; ++i) {
        const double error_m = *noisy(i, {0}, Roi{}).range_m - 0.47;
        sum += error_m;
        squares += error_m * error_m;
    }
    EXPECT_NEAR(sum / kDraws, 0.0, 7.1e-4);                  // five standard errors
    EXPECT_NEAR(std::sqrt(squares / kDraws), 0.02, 5.0e-4);  // likewise
    const double once = *noisy(17, {0}, Roi{}).range_m;
    EXPECT_EQ(*noisy(17, {0}, Roi{}).range_m, once);
    EXPECT_EQ(*scene(Eigen::Isometry3d::Identity(), 0.02, 9, 5)(17, {0}, Roi{}).range_m, once);
    EXPECT_NE(*scene(Eigen::Isometry3d::Identity(), 0.02, 9, 6)(17, {0}, Roi{}).range_m, once);
    EXPECT_NE(*scene(Eigen::Isometry3d::Identity(), 0.02, 8, 5)(17, {0}, Roi{}).range_m, once);
}

TEST_F(ExperimentSensor, reports_the_sigma_and_a_signal_that_no_limit_refuses) {
    const auto seen = scene(Eigen::Isometry3d::Identity(), 0.02)(0, {0}, Roi{});
    EXPECT_EQ(seen.sigma_m, 0.02);
    EXPECT_GT(seen.peak_signal_mcps, 1.0);
}

}  // namespace
}  // namespace octoskin::sim
