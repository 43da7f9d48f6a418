// The host's kinematic model from a URDF file.
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

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

/// The robot about its base link: what is above it, and all of its links.
struct RobotFrames {
    /// The link at the top of the fixed joints above the base link: the root of the URDF, or the link that a
    /// `floating` or `planar` joint carries. The base link itself if no fixed joint is above it.
    std::string root_link;
    std::string base_link;
    Eigen::Isometry3d T_root_base = Eigen::Isometry3d::Identity();
    std::vector<std::string> links;        ///< of the whole URDF, by name
    std::vector<JointDescription> joints;  ///< below the base link, parents first
};
/// Errors name the file: an unreadable URDF, what urdfdom refuses, an unknown base link, a joint below it
/// that `read_robot_model` refuses.
[[nodiscard]] Result<RobotFrames, Error> read_robot_frames(const FilePlace& urdf,
                                                           const std::string& base_link);

}  // namespace octoskin
