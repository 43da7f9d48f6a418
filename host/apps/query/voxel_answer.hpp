// The request `voxel` of the control socket: everything that the map holds about one voxel.
#pragma once

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "host/core/mapping/fused_map.hpp"

namespace octoskin {

/// "voxel {...}".
[[nodiscard]] bool is_voxel_request(const std::string& line);

/// The point of {"point_m": [x, y, z]}. Empty: no object with only this key, and three finite numbers.
[[nodiscard]] std::optional<Eigen::Vector3d> requested_point(std::string_view json);

/// Answers `voxel {"point_m": [x, y, z]}`, a point of the map frame in metres, at the map's own time:
/// advance it to the present before. Keys: docs/reference/control-socket.md. Refused: no such object; a point
/// outside of the octree. O(1).
[[nodiscard]] nlohmann::ordered_json answer_voxel(const std::string& line, const FusedMap& map);

}  // namespace octoskin
