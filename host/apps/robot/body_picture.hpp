// A picture of the meshes of a robot's links with the capsules around them.
#pragma once

#include <string>

#include "host/io/robot/robot_fit.hpp"

namespace octoskin {

/// SVG: a row for each link with a fit, seen along y, x and z of the link; the mesh in grey (at most 3000 of
/// its triangles), the capsules in orange. Each row has a scale of its own, which it names.
[[nodiscard]] std::string body_picture(const RobotFit& robot);

}  // namespace octoskin
