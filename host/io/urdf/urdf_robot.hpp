// The host's kinematic model from a URDF file.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "common/result.hpp"
#include "host/core/kinematics/robot_model.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin {

/// The links that hang below `base_link`, with `moved` as the joints that get positions, in that order.
/// Errors name file and element, and the line if it can be found: an unreadable file, whatever urdfdom
/// refuses (a joint without its link, a loop), an unknown base link or joint, a joint that moves but is not
/// in `moved`, a kind of joint other than fixed, revolute, continuous and prismatic, a mimic joint, an axis
/// whose length is not 1. All joints that cannot be taken are in one error.
[[nodiscard]] Result<RobotModel, rig::RigError> read_robot_model(const FilePlace& urdf,
                                                                 const std::string& base_link,
                                                                 std::span<const std::string> moved);

}  // namespace octoskin
