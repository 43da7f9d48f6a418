// A small arm for questions: a post on the origin, a turning upper arm along x, a sliding hand.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <numbers>
#include <string>
#include <vector>

#include "host/core/kinematics/robot_model.hpp"
#include "host/core/rig/host_rig.hpp"
#include "tests/support/evidence.hpp"

namespace octoskin {

/// Joints: turn about z (rad, -3 to 3), slide along the upper arm (m, 0 to 0.2). At 0, 0 the upper arm
/// reaches from (0, 0, 0.3) to (0.3, 0, 0.3), the hand is a ball about (0.4, 0, 0.3); both are 0.04 m thick.
struct TwoJointArm {
    HostRig rig;
    RobotModel robot;

    TwoJointArm() : robot(model()) {
        rig.joint_sources = {{.joints = {"turn", "slide"}}};
        rig.body = {{"post", {0, 0, 0}, {0, 0, 0.2}, 0.05},
                    {"upper", {0, 0, 0}, {0.3, 0, 0}, 0.04},
                    {"hand", {0, 0, 0}, {0, 0, 0}, 0.04}};
        rig.certain_body = rig.body;
        HostSensor sensor;
        sensor.name = "palm";
        sensor.link = "hand";  // looks ahead, along the arm
        sensor.T_link_sensor.linear() =
            Eigen::AngleAxisd(0.5 * std::numbers::pi, Eigen::Vector3d::UnitY()).toRotationMatrix();
        sensor.T_link_sensor.translation() = Eigen::Vector3d(0.03, 0, 0);
        HostNode node;
        node.node_id = 1;
        node.sensors = {sensor};
        rig.nodes = {node};
        rig.range_limits.max_m = 1.0;
    }

    static RobotModel model() {
        std::array<JointDescription, 2> joints;
        joints[0].name = "turn";
        joints[0].parent_link = "post";
        joints[0].child_link = "upper";
        joints[0].kind = JointKind::revolute;
        joints[0].T_parent_joint.translation() = Eigen::Vector3d(0, 0, 0.3);
        joints[0].limits = {-3.0, 3.0};
        joints[1].name = "slide";
        joints[1].parent_link = "upper";
        joints[1].child_link = "hand";
        joints[1].kind = JointKind::prismatic;
        joints[1].axis = Eigen::Vector3d::UnitX();
        joints[1].T_parent_joint.translation() = Eigen::Vector3d(0.4, 0, 0);
        joints[1].limits = {0.0, 0.2};
        const std::array<std::string, 2> moved{"turn", "slide"};
        auto built = RobotModel::build("post", joints, moved);
        EXPECT_TRUE(built);
        return std::move(built).value();
    }
};

/// Free within 32 voxels of 0.04 m of the origin along each axis, unknown beyond.
inline FusedMap free_about_origin(std::uint32_t stale_after_s = 0) {
    MapConfig config{.resolution_m = 0.04};
    config.age.stale_after_s = stale_after_s;
    FusedMap map{config};
    constexpr std::array<std::uint16_t, 2> kSides{32736, 32768};
    for (const auto x : kSides)
        for (const auto y : kSides)
            for (const auto z : kSides) EXPECT_TRUE(map.set_cube({{x, y, z}, 5}, -1.0F));
    return map;
}

/// All of its space is measured at an instant by range sensors.
inline void confirm_about_origin(FusedMap& map, HostTime now) {
    map.advance_time(now);
    std::vector<VoxelUpdate> updates;
    map.for_each_known([&](VoxelKey key, float) { updates.push_back({key, -0.4F}); });
    feed(map, updates, SensorKind::range);
}

inline void mark(FusedMap& map, const Eigen::Vector3d& point, float log_odds = 1.0F) {
    ASSERT_TRUE(map.set_cube({*map.key_of(point), 0}, log_odds));
}

/// A map in which voxels are unknown again: all that is known but those within the box.
inline FusedMap without(const FusedMap& map, const Eigen::Vector3d& lowest, const Eigen::Vector3d& highest) {
    FusedMap less(map.config());
    map.for_each_known([&](VoxelKey key, float log_odds) {
        const Eigen::Vector3d centre = map.centre_of(key);
        const bool is_inside =
            (centre.array() > lowest.array()).all() && (centre.array() < highest.array()).all();
        if (is_inside) return;
        EXPECT_TRUE(less.set_cube({key, 0}, log_odds));
    });
    return less;
}

}  // namespace octoskin
