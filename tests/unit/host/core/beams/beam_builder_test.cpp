// Poses and distances worked out by hand.
#include "host/core/beams/beam_builder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "host/core/kinematics/self_hit.hpp"

namespace octoskin {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

RobotModel robot() {
    const std::vector<JointDescription> joints = {{.name = "lift",
                                                   .parent_link = "base",
                                                   .child_link = "carriage",
                                                   .kind = JointKind::prismatic,
                                                   .T_parent_joint = Eigen::Isometry3d::Identity(),
                                                   .axis = Eigen::Vector3d::UnitZ(),
                                                   .limits = {0.0, 2.0}}};
    const std::vector<std::string> moved = {"lift"};
    return RobotModel::build("base", joints, moved).value();
}

/// On the carriage 0.3 m out along x, looking along +x; a second zone looks 45 degrees towards +z. A ball of
/// radius 0.1 m stands on the base at (1.0, 0, 0.5); the carriage is a ball of radius 0.4 m itself.
HostRig rig() {
    HostRig rig;
    rig.T_map_base.translation() = Eigen::Vector3d(10.0, 20.0, 30.0);
    rig.T_map_base.linear() << 0, -1, 0, 1, 0, 0, 0, 0, 1;  // base x is map y
    HostSensor sensor;
    sensor.link = "carriage";
    sensor.T_link_sensor.translation().x() = 0.3;
    sensor.T_link_sensor.linear() << 0, 0, 1, 1, 0, 0, 0, 1, 0;  // sensor z is base x, sensor y is base z
    sensor.zones.push_back(
        {.offset_m = 0.0, .direction_sensor = Eigen::Vector3d(0, 1, 1).normalized(), .optics = {}});
    rig.nodes.push_back(
        {.node_id = 4, .name = "n", .node_hash = 0, .pinned_build_id = {}, .sensors = {sensor}});
    rig.joint_sources = {{.joints = {"lift"}}};
    rig.body = {{"base", {1, 0, 0.5}, {1, 0, 0.5}, 0.1}, {"carriage", {0, 0, 0}, {0, 0, 0}, 0.4}};
    rig.links_ignored_by_sensors = {"carriage"};
    return rig;
}

RobotPose pose_at(double lift_m, const HostRig& of = rig()) {
    const RobotModel model = robot();
    RobotPose pose;
    pose.T_base_link.resize(model.link_count());
    const std::array<double, 1> position = {lift_m};
    model.forward(position, pose.T_base_link);
    RobotBody::build(of.body, model)->pose(pose.T_base_link, pose.body_base);
    return pose;
}

RangeMeasurement measurement(std::optional<double> range_m, std::uint8_t zone = 0) {
    return {.source = {4, 0, zone}, .captured = {123}, .range_m = range_m, .sigma_m = 0.01};
}
BeamBuilder builder(const BeamRules& rules = {}, const HostRig& of = rig()) {
    return BeamBuilder::build(of, robot(), rules).value();
}

TEST(BeamBuilder, places_a_range_in_the_map_frame) {
    const auto beam = builder().place(measurement(2.0), pose_at(1.0));
    ASSERT_TRUE(beam.has_value());
    EXPECT_TRUE(beam->p_map_sensor.isApprox(Eigen::Vector3d(10.0, 20.3, 31.0)));
    EXPECT_TRUE(beam->direction_map.isApprox(Eigen::Vector3d(0, 1, 0)));
    EXPECT_EQ(beam->range_m, 2.0);
    EXPECT_EQ(beam->captured.ns, 123);
    EXPECT_EQ(beam->source, (BeamSource{4, 0, 0}));
    EXPECT_EQ(beam->clear_limit_m, 0.0);
    EXPECT_EQ(beam->sigma_m, 0.01);
}

TEST(BeamBuilder, lets_each_zone_look_its_own_way) {
    const auto beam = builder().place(measurement(2.0, 1), pose_at(1.0));
    ASSERT_TRUE(beam.has_value());
    EXPECT_TRUE(beam->direction_map.isApprox(Eigen::Vector3d(0, std::sqrt(0.5), std::sqrt(0.5))));
}

TEST(BeamBuilder, refuses_a_range_that_reaches_the_robot_less_the_margin) {
    // At lift 0.5 the ball's surface is 0.9 - 0.3 = 0.6 m ahead; margin 0.12 m.
    EXPECT_TRUE(builder().place(measurement(0.479), pose_at(0.5)).has_value());
    EXPECT_EQ(builder().place(measurement(0.481), pose_at(0.5)).error(), BeamFault::self_hit);
    EXPECT_TRUE(builder().place(measurement(2.0), pose_at(0.7)).has_value()) << "the beam passes above it";
    EXPECT_TRUE(builder({.removes_robot = false}).place(measurement(2.0), pose_at(0.5)).has_value());
}

TEST(BeamBuilder, counts_the_link_that_carries_the_sensor_unless_the_rig_ignores_it) {
    HostRig strict = rig();
    strict.links_ignored_by_sensors.clear();
    EXPECT_EQ(builder({}, strict).place(measurement(0.2), pose_at(1.0, strict)).error(), BeamFault::self_hit);
}

TEST(BeamBuilder, caps_the_space_that_a_beam_without_return_clears) {
    const BeamRules rules{.removes_robot = true, .no_return_clear_m = 1.5};
    EXPECT_NEAR(builder(rules).place(measurement(std::nullopt), pose_at(1.0))->clear_limit_m, 1.5, 1e-12);
    EXPECT_NEAR(builder(rules).place(measurement(std::nullopt), pose_at(0.5))->clear_limit_m, 0.48, 1e-12);
    HostRig wide = rig();
    wide.range_self_margin_m = 0.7;
    EXPECT_EQ(builder(rules, wide).place(measurement(std::nullopt), pose_at(0.5)).error(),
              BeamFault::self_hit);
}

TEST(BeamBuilder, refuses_poses_that_are_no_numbers) {
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(), kInfinity, -kInfinity}) {
        for (int row = 0; row < 3; ++row) {
            for (int column = 0; column < 4; ++column) {
                RobotPose pose = pose_at(1.0);
                for (Eigen::Isometry3d& T : pose.T_base_link) {
                    T.matrix()(row, column) = bad;
                }
                EXPECT_EQ(builder().place(measurement(2.0), pose).error(), BeamFault::not_finite);
            }
        }
    }
}

// From 0.12 m above its middle the axis passes over the ball, 0.7 m away. The cone's rays half as far from
// the axis as its edge are 0.083 m lower there, and meet it at 0.62 m: less the margin, 0.5 m are free.
TEST(BeamBuilder, looks_for_the_robot_in_the_whole_cone) {
    HostRig with_cone = rig();
    with_cone.nodes[0].sensors[0].zones[0].optics = {.half_angle_rad = 0.2356, .sigma_rad = 0.12};
    const BeamRules rules{.removes_robot = true, .no_return_clear_m = 0.0, .sees_cones = true};
    EXPECT_TRUE(builder().place(measurement(0.8), pose_at(0.62)).has_value());
    EXPECT_TRUE(builder(rules).place(measurement(0.8), pose_at(0.62)).has_value());
    EXPECT_EQ(builder(rules, with_cone).place(measurement(0.8), pose_at(0.62)).error(), BeamFault::self_hit);
    EXPECT_TRUE(builder({}, with_cone).place(measurement(0.8), pose_at(0.62)).has_value());
    // Nearer than the ball less the margin, or well beside it.
    EXPECT_TRUE(builder(rules, with_cone).place(measurement(0.4), pose_at(0.62)).has_value());
    EXPECT_TRUE(builder(rules, with_cone).place(measurement(0.8), pose_at(1.2)).has_value());
}

TEST(BeamBuilder, gives_beams_their_optics_where_cones_count) {
    HostRig with_cone = rig();
    const BeamOptics optics{.half_angle_rad = 0.2, .sigma_rad = 0.1};
    with_cone.nodes[0].sensors[0].zones[0].optics = optics;
    EXPECT_EQ(builder({.removes_robot = true, .no_return_clear_m = 0.0, .sees_cones = true}, with_cone)
                  .place(measurement(0.3), pose_at(1.5))
                  ->optics,
              optics);
    EXPECT_EQ(builder({}, with_cone).place(measurement(0.3), pose_at(1.5))->optics, BeamOptics{});
}

}  // namespace
}  // namespace octoskin
