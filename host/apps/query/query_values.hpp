// Values of a query's answer as JSON.
#pragma once

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "common/time.hpp"
#include "host/core/kinematics/robot_model.hpp"
#include "host/core/mapping/fused_map.hpp"
#include "host/core/query/path_query.hpp"

namespace octoskin {

/// Rounded to a micrometre, with as many digits as that needs.
[[nodiscard]] nlohmann::ordered_json rounded(const std::optional<double>& metres);
/// Rounded to a millisecond.
[[nodiscard]] nlohmann::ordered_json seconds_json(const std::optional<WallTime>& time);
[[nodiscard]] nlohmann::ordered_json point_json(const Eigen::Vector3d& point);

/// An entry of "legs". `map`, `robot`: those of the query.
[[nodiscard]] nlohmann::ordered_json leg_json(const LegAnswer& answer, const FusedMap& map,
                                              const RobotModel& robot);
/// "free_evidence" of a way; null without free space.
[[nodiscard]] nlohmann::ordered_json free_json(const std::optional<PostureFree>& free, const FusedMap& map,
                                               const RobotModel& robot);

}  // namespace octoskin
