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
    constexpr double kOpposite = -1.0 + 1e-12;
    if (z < kOpposite) return Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal();
    const double share = 1.0 / (1.0 + z);
    Eigen::Matrix3d R;
    R << 1.0 - share * x * x, -share * x * y, x,  //
        -share * x * y, 1.0 - share * y * y, y,   //
        -x, -y, z;
    return R;
}

}  // namespace octoskin
