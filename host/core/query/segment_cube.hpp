// How far a segment is from a cube: the geometry of "does this capsule touch that voxel".
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace octoskin {

/// A segment prepared for many questions. All lengths in metres, one frame. Ends are finite (asserted).
class SegmentToCubes {
  public:
    SegmentToCubes(const Eigen::Vector3d& p_a, const Eigen::Vector3d& p_b) noexcept;

    /// From the segment to the closed cube with this centre, 0 if they meet: the minimum along the segment of
    /// a convex function that is a parabola between the places where the segment passes a plane of the cube's
    /// faces. Exact but for rounding, some 1e-15 of the largest coordinate. About 50 ns.
    [[nodiscard]] double distance(const Eigen::Vector3d& centre, double half_edge) const noexcept;
    /// The distance is this or more, but for rounding as above; NaN if the segment passes the centre. From
    /// the plane that divides the two and is square to the way from the centre to the segment. About 10 ns.
    [[nodiscard]] double distance_at_least(const Eigen::Vector3d& centre, double half_edge) const noexcept;
    /// Whether that bound is above `limit_m`; false if the segment passes the centre. About 5 ns.
    [[nodiscard]] bool is_surely_beyond(const Eigen::Vector3d& centre, double half_edge,
                                        double limit_m) const noexcept {
        const Eigen::Vector3d nearest = nearest_to(centre);
        const double squared = nearest.squaredNorm();
        const double depth =
            half_edge * (std::abs(nearest.x()) + std::abs(nearest.y()) + std::abs(nearest.z()));
        const double beyond = squared - depth;  // the bound, times the way to the centre
        return beyond > 0.0 && (limit_m < 0.0 || beyond * beyond > limit_m * limit_m * squared);
    }

  private:
    /// From the centre to the segment's point that is nearest to it.
    [[nodiscard]] Eigen::Vector3d nearest_to(const Eigen::Vector3d& centre) const noexcept {
        const Eigen::Vector3d from = p_a_ - centre;
        const double t = std::clamp(-from.dot(axis_) * inverse_length_squared_, 0.0, 1.0);
        return from + t * axis_;
    }

    Eigen::Vector3d p_a_;
    Eigen::Vector3d axis_;
    Eigen::Vector3d inverse_axis_;  ///< of each coordinate; 0 of a 0
    double inverse_length_squared_;
};

}  // namespace octoskin
