// A part of the robot's body as a capsule in space, with the distance of a point from its surface and the
// entry point of a ray.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <optional>

namespace octoskin {

/// Index of a link in its RobotModel.
using LinkId = std::uint16_t;

/// All points within `radius_m` of the segment from p_a to p_b, metres; equal ends are a sphere. The owner
/// states the frame.
struct PosedCapsule {
    Eigen::Vector3d p_a = Eigen::Vector3d::Zero();
    Eigen::Vector3d p_b = Eigen::Vector3d::Zero();
    double radius_m = 0.0;
    LinkId link = 0;  ///< the link it belongs to
};

/// Signed distance from `point` to the capsule's surface, metres: negative inside. Same frame as the capsule.
/// NaN for a point with a NaN. About 5 ns.
[[nodiscard]] inline double distance_to_surface(const PosedCapsule& capsule,
                                                const Eigen::Vector3d& point) noexcept {
    const Eigen::Vector3d axis = capsule.p_b - capsule.p_a;
    const Eigen::Vector3d from_a = point - capsule.p_a;
    const double length_squared = axis.squaredNorm();
    const double along = length_squared > 0.0 ? std::clamp(from_a.dot(axis) / length_squared, 0.0, 1.0) : 0.0;
    return (from_a - along * axis).norm() - capsule.radius_m;
}

/// The range in metres at which the ray from `origin` along the unit vector `direction` first meets the
/// capsule; 0 if it starts inside, empty if it never does or if any number is NaN. Same frame as the capsule.
/// Analytic: accurate to about 1e-9 m over 10 m. Below 50 ns.
[[nodiscard]] std::optional<double> ray_entry(const PosedCapsule& capsule, const Eigen::Vector3d& origin,
                                              const Eigen::Vector3d& direction) noexcept;

}  // namespace octoskin
