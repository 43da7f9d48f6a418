// The distance of a segment from a cube by numerical search: slow, and independent of the host's formulas.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace octoskin {

/// From the segment to the closed cube, to some 1e-12 of its length: golden section, as the distance along a
/// segment has one minimum. About 0.5 us.
inline double sampled_distance(const Eigen::Vector3d& p_a, const Eigen::Vector3d& p_b,
                               const Eigen::Vector3d& centre, double half_edge) {
    const auto squared_at = [&](double t) {
        const Eigen::Vector3d point = p_a + t * (p_b - p_a) - centre;
        return (point.cwiseAbs().array() - half_edge).max(0.0).square().sum();
    };
    constexpr double kGolden = 0.6180339887498949;
    double lower = 0.0;
    double upper = 1.0;
    double left = upper - kGolden * (upper - lower);
    double right = lower + kGolden * (upper - lower);
    double at_left = squared_at(left);
    double at_right = squared_at(right);
    for (int i = 0; i < 62; ++i) {
        if (at_left <= at_right) {
            upper = right;
            right = left;
            at_right = at_left;
            left = upper - kGolden * (upper - lower);
            at_left = squared_at(left);
        } else {
            lower = left;
            left = right;
            at_left = at_right;
            right = lower + kGolden * (upper - lower);
            at_right = squared_at(right);
        }
    }
    return std::sqrt(std::min({squared_at(0.0), squared_at(1.0), at_left, at_right}));
}

}  // namespace octoskin
