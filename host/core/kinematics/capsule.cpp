#include "host/core/kinematics/capsule.hpp"

#include <cmath>

namespace octoskin {
namespace {

/// The nearer positive root of |offset + range * slope|^2 = radius^2 for an origin outside. `offset` and
/// `slope` are full vectors for a sphere, or their parts across the axis for an infinite cylinder.
std::optional<double> first_root(const Eigen::Vector3d& offset, const Eigen::Vector3d& slope,
                                 double radius_m) {
    const double quadratic = slope.squaredNorm();
    const double half_linear = offset.dot(slope);
    // For a ray along the axis, the slope across it is 0: such a ray enters through an end or not at all.
    if (!(quadratic > 1e-18) || !(half_linear < 0.0)) return std::nullopt;
    // The distance of closest approach is computed from its own vector: the usual b^2 - ac loses half the
    // digits for a far origin.
    const Eigen::Vector3d closest = offset - (half_linear / quadratic) * slope;
    const double chord_squared = radius_m * radius_m - closest.squaredNorm();
    if (!(chord_squared >= 0.0)) return std::nullopt;
    return (-half_linear - std::sqrt(chord_squared * quadratic)) / quadratic;
}

std::optional<double> nearer(std::optional<double> left, std::optional<double> right) {
    if (!left) return right;
    if (!right) return left;
    return std::min(*left, *right);
}

/// Range at which the ray enters the wall between the two ends.
std::optional<double> wall_entry(const PosedCapsule& capsule, const Eigen::Vector3d& origin,
                                 const Eigen::Vector3d& direction) {
    const Eigen::Vector3d axis = capsule.p_b - capsule.p_a;
    const double length_m = axis.norm();
    if (!(length_m > 0.0)) return std::nullopt;
    const Eigen::Vector3d unit_axis = axis / length_m;
    const Eigen::Vector3d from_a = origin - capsule.p_a;
    const double offset_along = from_a.dot(unit_axis);
    const double slope_along = direction.dot(unit_axis);
    const auto range_m =
        first_root(from_a - offset_along * unit_axis, direction - slope_along * unit_axis, capsule.radius_m);
    if (!range_m) return std::nullopt;
    const double along_m = offset_along + *range_m * slope_along;
    return along_m >= 0.0 && along_m <= length_m ? range_m : std::nullopt;
}

}  // namespace

std::optional<double> ray_entry(const PosedCapsule& capsule, const Eigen::Vector3d& origin,
                                const Eigen::Vector3d& direction) noexcept {
    if (distance_to_surface(capsule, origin) <= 0.0) return 0.0;
    // For an origin outside a convex body, the entry is the nearest point at which the ray meets a part of
    // the surface.
    const auto ends = nearer(first_root(origin - capsule.p_a, direction, capsule.radius_m),
                             first_root(origin - capsule.p_b, direction, capsule.radius_m));
    return nearer(wall_entry(capsule, origin, direction), ends);
}

}  // namespace octoskin
