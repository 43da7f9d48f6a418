// The rig file as the host core wants it.
#pragma once

#include <string>
#include <vector>

#include "common/result.hpp"
#include "host/core/kinematics/robot_model.hpp"
#include "host/core/rig/host_rig.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin {

/// The rig in the host's terms, and the robot it stands on.
struct HostSetup {
    HostRig rig;
    RobotModel robot;  ///< from rig.base_link; joint vectors in the order of rig.joints.joints
    /// What is allowed and hardly meant, a sentence each, for whoever started the program.
    std::vector<std::string> warnings;
    /// What is as it may be, and worth a look, likewise.
    std::vector<std::string> notes = {};
};

[[nodiscard]] HostCamera host_camera(const rig::Camera& camera);

/// Takes over what the host core needs and reads the robot's body and kinematics from `rig.urdf`. Errors:
/// those of the URDF, and a body capsule on a link that does not hang below the rig's base link.
[[nodiscard]] Result<HostSetup, rig::RigError> make_host_setup(const rig::Rig& rig);

}  // namespace octoskin
