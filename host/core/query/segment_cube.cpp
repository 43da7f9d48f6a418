#include "host/core/query/segment_cube.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace octoskin {
namespace {

double inverse_of(double value) {
    return value != 0.0 ? 1.0 / value : 0.0;
}

/// Distance of each coordinate beyond a cube about 0.
Eigen::Vector3d beyond(const Eigen::Vector3d& point, double half_edge) {
    return point - point.cwiseMax(-half_edge).cwiseMin(half_edge);
}

}  // namespace

SegmentToCubes::SegmentToCubes(const Eigen::Vector3d& p_a, const Eigen::Vector3d& p_b) noexcept
    : p_a_(p_a),
      axis_(p_b - p_a),
      inverse_axis_(inverse_of(axis_.x()), inverse_of(axis_.y()), inverse_of(axis_.z())),
      inverse_length_squared_(inverse_of(axis_.squaredNorm())) {
    assert(p_a.allFinite() && p_b.allFinite());
}

double SegmentToCubes::distance(const Eigen::Vector3d& centre, double half_edge) const noexcept {
    const Eigen::Vector3d from = p_a_ - centre;
    const auto distance_at = [&](double t) { return beyond(from + t * axis_, half_edge).norm(); };
    // Half the derivative of the squared distance: continuous, piecewise linear, never decreasing.
    const auto slope_at = [&](double t) { return beyond(from + t * axis_, half_edge).dot(axis_); };
    double lower = 0.0;
    double upper = 1.0;
    double slope_lower = slope_at(lower);
    double slope_upper = slope_at(upper);
    if (slope_lower >= 0.0) return distance_at(lower);
    if (slope_upper <= 0.0) return distance_at(upper);
    for (int i = 0; i < 3; ++i) {
        for (const double side : {-half_edge, half_edge}) {
            const double t = (side - from[i]) * inverse_axis_[i];
            if (!(t > lower && t < upper)) continue;
            const double slope = slope_at(t);
            if (slope == 0.0) return distance_at(t);
            (slope < 0.0 ? lower : upper) = t;
            (slope < 0.0 ? slope_lower : slope_upper) = slope;
        }
    }
    return distance_at(lower + (upper - lower) * slope_lower / (slope_lower - slope_upper));
}

double SegmentToCubes::distance_at_least(const Eigen::Vector3d& centre, double half_edge) const noexcept {
    const Eigen::Vector3d nearest = nearest_to(centre);
    return (nearest.squaredNorm() - half_edge * nearest.lpNorm<1>()) / nearest.norm();
}

}  // namespace octoskin
