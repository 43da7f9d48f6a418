// The rotations of URDF's <origin>.
#pragma once

#include <Eigen/Geometry>
#include <cmath>

namespace octoskin::rig {

/// Turns by rpy[0] about x, then by rpy[1] about the fixed y, then by rpy[2] about the fixed z, radians.
[[nodiscard]] inline Eigen::Matrix3d rotation_of_rpy(const Eigen::Vector3d& rpy) {
    return (Eigen::AngleAxisd(rpy[2], Eigen::Vector3d::UnitZ()) *
            Eigen::AngleAxisd(rpy[1], Eigen::Vector3d::UnitY()) *
            Eigen::AngleAxisd(rpy[0], Eigen::Vector3d::UnitX()))
        .toRotationMatrix();
}

/// The inverse, for any rotation.
[[nodiscard]] inline Eigen::Vector3d rpy_of(const Eigen::Matrix3d& rotation) {
    const double across = std::hypot(rotation(0, 0), rotation(1, 0));
    const double pitch = std::atan2(-rotation(2, 0), across);
    if (across < 1e-9)  // roll and yaw turn about the same axis
        return {std::atan2(-rotation(1, 2), rotation(1, 1)), pitch, 0.0};
    return {std::atan2(rotation(2, 1), rotation(2, 2)), pitch, std::atan2(rotation(1, 0), rotation(0, 0))};
}

}  // namespace octoskin::rig
