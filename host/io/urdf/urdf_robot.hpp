// The host's kinematic model from a URDF file.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "common/result.hpp"
#include "host/core/kinematics/robot_model.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin {

/// Reads the links below `base_link`; `moved` are the joints with positions, in that order.
/// Errors name file and element, and the line if it can be found: an unreadable file; what urdfdom refuses (a
/// joint without its link, a loop); an unknown base link or joint; a moving joint that is not in `moved`; a
/// joint other than fixed, revolute, continuous and prismatic; an axis whose length is not 1.
/// One error contains all joints that cannot be used.
[[nodiscard]] Result<RobotModel, Error> read_robot_model(const FilePlace& urdf, const std::string& base_link,
                                                         std::span<const std::string> moved);

}  // namespace octoskin
