// Converts the rig file to the types of the host core.
#pragma once

#include <string>
#include <vector>

#include "common/result.hpp"
#include "host/core/kinematics/robot_model.hpp"
#include "host/core/rig/host_rig.hpp"
#include "host/io/urdf/urdf_robot.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin {

/// The rig in the host's types, and its robot.
struct HostSetup {
    HostRig rig;
    RobotModel robot;  ///< from rig.base_link; joint vectors in the order of rig.joint_names()
    /// Valid but probably unintended settings, one sentence each, for the user.
    std::vector<std::string> warnings;
    /// Valid settings that the user may want to check, likewise.
    std::vector<std::string> notes = {};
    RobotFrames frames = {};
};

[[nodiscard]] HostCamera host_camera(const rig::Camera& camera);

/// Converts what the host core needs, and reads the robot's body and kinematics from `rig.urdf`. Errors:
/// those of the URDF, and a body capsule on a link that is not below the rig's base link.
[[nodiscard]] Result<HostSetup, Error> make_host_setup(const rig::Rig& rig);

}  // namespace octoskin
