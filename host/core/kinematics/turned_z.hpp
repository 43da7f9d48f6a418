// The rotation from z to a direction.
#pragma once

#include <Eigen/Core>

namespace octoskin {

/// The smallest rotation, about an axis perpendicular to both. `direction` has length 1. For -z, where that
/// axis is not defined: half a turn about x. Same as Eigen's `FromTwoVectors`, which takes the compiler ten
/// seconds.
[[nodiscard]] inline Eigen::Matrix3d turned_z(const Eigen::Vector3d& direction) {
    const double x = direction.x();
    const double y = direction.y();
    const double z = direction.z();
    const double across = x * x + y * y;
    if (z < 0.0 && across < 1e-30) return Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal();
    const double share = z < 0.0 ? (1.0 - z) / across : 1.0 / (1.0 + z);  // equal except for rounding
    Eigen::Matrix3d R;
    R << 1.0 - share * x * x, -share * x * y, x,  //
        -share * x * y, 1.0 - share * y * y, y,   //
        -x, -y, z;
    return R;
}

}  // namespace octoskin
