// The motion of a body on the robot with one of its joints.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>

namespace octoskin {

inline constexpr std::size_t kJointsMax = 32;  ///< of a robot
/// A set of moved joints: bit i is joint i of all joint vectors.
using JointSet = std::uint32_t;

/// A point p moves by turn x p + shift per radian of the joint, or per metre of a prismatic joint. Zero: the
/// joint does not move it. The owner states the frame.
struct JointTwist {
    Eigen::Vector3d turn = Eigen::Vector3d::Zero();
    Eigen::Vector3d shift = Eigen::Vector3d::Zero();
};
/// In the order of all joint vectors.
using JointTwists = std::array<JointTwist, kJointsMax>;

/// Transforms a twist from frame b to frame a. About 10 ns.
[[nodiscard]] inline JointTwist placed(const Eigen::Isometry3d& T_a_b, const JointTwist& twist_b) {
    const Eigen::Vector3d turn = T_a_b.linear() * twist_b.turn;
    return {.turn = turn, .shift = T_a_b.linear() * twist_b.shift - turn.cross(T_a_b.translation())};
}

[[nodiscard]] inline JointTwists placed(const Eigen::Isometry3d& T_a_b, JointTwists twists) {
    for (JointTwist& twist : twists) {
        const bool moves = !twist.turn.isZero(0.0) || !twist.shift.isZero(0.0);
        if (moves) twist = placed(T_a_b, twist);
    }
    return twists;
}

}  // namespace octoskin
