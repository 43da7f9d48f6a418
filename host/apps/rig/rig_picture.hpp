// A picture of a rig: arm, sensors with their cones, and the cameras' views.
#pragma once

#include <span>
#include <string>

#include "host/io/rig/host_rig_reader.hpp"

namespace octoskin {

/// A posture within the limits: each joint at 0, or at the nearest limit.
[[nodiscard]] std::vector<double> posture_at_rest(const RobotModel& robot);

/// SVG in the base frame, from the side, from the front and from above. The arm's capsules are grey; a sensor
/// is a dot with 25 cm of each zone's cone, or of its ray, in a colour of its node, and its name appears
/// under the pointer; a camera is a pyramid of 50 cm. A line of the ground grid is 0.5 m long.
/// `position`: of each moved joint.
[[nodiscard]] std::string rig_picture(const HostSetup& setup, std::span<const double> position);

}  // namespace octoskin
