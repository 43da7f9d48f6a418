// The rotation that turns z into a direction.
#pragma once

#include <Eigen/Core>

namespace octoskin {

/// The smallest one: about an axis across both. `direction` has length 1. Of -z, which has none, half a turn
/// about x. Eigen's `FromTwoVectors` is the same, but takes the compiler ten seconds.
[[nodiscard]] inline Eigen::Matrix3d turned_z(const Eigen::Vector3d& direction) {
    const double x = direction.x();
    const double y = direction.y();
    const double z = direction.z();
    const double across = x * x + y * y;
    if (z < 0.0 && across < 1e-30) return Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal();
    const double share = z < 0.0 ? (1.0 - z) / across : 1.0 / (1.0 + z);  // the same, but for rounding
    Eigen::Matrix3d R;
    R << 1.0 - share * x * x, -share * x * y, x,  //
        -share * x * y, 1.0 - share * y * y, y,   //
        -x, -y, z;
    return R;
}

}  // namespace octoskin
