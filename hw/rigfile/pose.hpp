// Reads poses of the rig file: a position and an orientation in one of several notations.
#pragma once

#include <Eigen/Geometry>
#include <string>

#include "hw/rigfile/rig_keys.hpp"
#include "hw/rigfile/table.hpp"

namespace octoskin::rig {

struct PoseRules {
    double reach_m = keys::pose::kSensorReach_m;  ///< limit of each coordinate
    bool may_look_at_point = false;               ///< allows `looking_at_m` (cameras)
};

/// A list of three numbers within the reach, metres.
[[nodiscard]] Eigen::Vector3d read_position(const Value& value, const std::string& path, double reach_m);
/// The position of a key; its reach is the greatest value of the key's range.
[[nodiscard]] Eigen::Vector3d read_position(const Table& table, const NumbersKey& key);

/// T_parent_child from `xyz_m` and one of
/// - `rpy_deg`: roll, pitch, yaw about the parent's fixed x, y, z, as in URDF;
/// - `quaternion_wxyz`: of length 1 within 1e-6;
/// - `rotation_rows`: the rotation matrix row by row, orthonormal within 1e-9; kept to the last bit;
/// - `looking_at_m` (cameras): a point on the optical axis; the picture's top is up (+z of base).
[[nodiscard]] Eigen::Isometry3d read_pose(const Value& value, const std::string& path,
                                          const PoseRules& rules);

}  // namespace octoskin::rig
