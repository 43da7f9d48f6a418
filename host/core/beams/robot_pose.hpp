// The whole robot at one instant.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "host/core/kinematics/capsule.hpp"
#include "host/core/kinematics/joint_twist.hpp"

namespace octoskin {

struct RobotPose {
    std::vector<Eigen::Isometry3d> T_base_link;  ///< by LinkId; of an unplaced link any pose
    /// Its capsules, base frame. Of an unplaced link, a ball that holds the capsule wherever the link is.
    std::vector<PosedCapsule> body_base;
    /// Joints without a position at this instant. A link is unplaced if one of them is above it
    /// (RobotModel::joints_above).
    JointSet unknown = 0;
};

}  // namespace octoskin
