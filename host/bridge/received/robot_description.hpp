// The robot that ROS 2 describes, compared with the daemon's.
#pragma once

#include <string>

#include "host/bridge/robot/robot_facts.hpp"

namespace octoskin::bridge {

/// A sentence with the links that the URDF text lacks or has in addition, or the first joint below the base
/// link that differs in its links, origin, axis or kind; empty if there is none. Safe for any text; at most
/// 16 MiB of it are read.
[[nodiscard]] std::string description_differs(const std::string& urdf, const RobotFacts& robot);

}  // namespace octoskin::bridge
