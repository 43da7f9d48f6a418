// One capsule around points that takes little space beyond the link.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <span>
#include <vector>

#include "host/core/body_fit/excess_field.hpp"
#include "host/core/kinematics/capsule.hpp"

namespace octoskin {

/// A point may be this far outside of the capsule.
inline constexpr double kSlack_m = 0.0018;
inline constexpr double kRadiusMin_m = 0.001;

/// The axes of the points' spread, as columns, the shortest first. `points` is not empty.
[[nodiscard]] Eigen::Matrix3d main_axes(std::span<const Eigen::Vector3d> points);

struct ScoredCapsule {
    PosedCapsule capsule;
    double excess = 0.0;  ///< ExcessField::excess
};

/// The points that are farthest in about 200 directions: few points that determine a capsule nearly.
[[nodiscard]] std::vector<Eigen::Vector3d> extreme_points(std::span<const Eigen::Vector3d> points);

/// Improves the place of `start` and sets its radius so that it covers `points`, by a pattern search of fixed
/// length.
[[nodiscard]] ScoredCapsule improved(const PosedCapsule& start, std::span<const Eigen::Vector3d> points,
                                     const ExcessField& field, int rounds);

/// From the smallest capsules along many directions. `points` is not empty.
[[nodiscard]] ScoredCapsule capsule_around(std::span<const Eigen::Vector3d> points, const ExcessField& field,
                                           int rounds);

}  // namespace octoskin
