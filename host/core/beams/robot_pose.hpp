// The whole robot at one instant.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "host/core/kinematics/capsule.hpp"

namespace octoskin {

struct RobotPose {
    std::vector<Eigen::Isometry3d> T_base_link;  ///< by LinkId
    std::vector<PosedCapsule> body_base;         ///< its capsules, base frame
};

}  // namespace octoskin
