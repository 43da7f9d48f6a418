// What `octoskin robot` says of a fitted robot.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "host/io/robot/robot_fit.hpp"

namespace octoskin {

/// Lines for people: joints with their limits, then for each link the source of its body and how it fits.
[[nodiscard]] std::string robot_text(const RobotFit& robot);

/// {"base_link", "joints": [{"name", "kind", "lower", "upper"}], "links": [{"name", "moves", "body",
/// "shapes", "kept", "files", "triangles", "capsules", "covered_within_m", "excess_ratio",
/// "protrusion_p95_m", "protrusion_p99_m", "protrusion_max_m"}], "missing": [names]}. Metres and radians; a
/// value that does not exist is null.
[[nodiscard]] nlohmann::ordered_json robot_json(const RobotFit& robot);

}  // namespace octoskin
