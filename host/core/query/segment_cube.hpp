// The distance from a segment to a cube: the test whether a capsule touches a voxel.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace octoskin {

/// A segment prepared for many queries. All lengths are in metres, in one frame. The ends are finite
/// (asserted).
class SegmentToCubes {
  public:
    SegmentToCubes(const Eigen::Vector3d& p_a, const Eigen::Vector3d& p_b) noexcept;

    /// Distance from the segment to the closed cube with this centre, 0 if they meet. It is the minimum along
    /// the segment of a convex function that is a parabola between the points at which the segment passes a
    /// plane of the cube's faces. Exact except for rounding, about 1e-15 of the largest coordinate. About 50
    /// ns.
    [[nodiscard]] double distance(const Eigen::Vector3d& centre, double half_edge) const noexcept;
    /// A lower bound of the distance, except for rounding as above; NaN if the segment passes the centre. It
    /// uses the plane between the two that is perpendicular to the line from the centre to the segment. About
    /// 10 ns.
    [[nodiscard]] double distance_at_least(const Eigen::Vector3d& centre, double half_edge) const noexcept;
    /// True if that bound is above `limit_m`; false if the segment passes the centre. About 5 ns.
    [[nodiscard]] bool is_surely_beyond(const Eigen::Vector3d& centre, double half_edge,
                                        double limit_m) const noexcept {
        const Eigen::Vector3d nearest = nearest_to(centre);
        const double squared = nearest.squaredNorm();
        const double depth =
            half_edge * (std::abs(nearest.x()) + std::abs(nearest.y()) + std::abs(nearest.z()));
        const double beyond = squared - depth;  // the bound times the distance to the centre
        return beyond > 0.0 && (limit_m < 0.0 || beyond * beyond > limit_m * limit_m * squared);
    }

  private:
    /// Vector from the centre to the segment's nearest point.
    [[nodiscard]] Eigen::Vector3d nearest_to(const Eigen::Vector3d& centre) const noexcept {
        const Eigen::Vector3d from = p_a_ - centre;
        const double t = std::clamp(-from.dot(axis_) * inverse_length_squared_, 0.0, 1.0);
        return from + t * axis_;
    }

    Eigen::Vector3d p_a_;
    Eigen::Vector3d axis_;
    Eigen::Vector3d inverse_axis_;  ///< 1 / coordinate; 0 for 0
    double inverse_length_squared_;
};

}  // namespace octoskin
