// Positions of cubes of voxels.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "host/core/voxels/key_box.hpp"
#include "host/core/voxels/voxel_lattice.hpp"

namespace octoskin {

/// Key of the octree's voxel nearest to a point (metres, map frame).
[[nodiscard]] inline VoxelKey key_near(const Eigen::Vector3d& point, double resolution_m) {
    const auto along = [&](double coordinate) {
        const double key = std::floor(coordinate / resolution_m) + kOriginKey;
        return static_cast<std::uint16_t>(std::clamp(key, 0.0, kVoxelsPerAxis - 1.0));
    };
    return {along(point.x()), along(point.y()), along(point.z())};
}

/// Half of the cube's edge, metres.
[[nodiscard]] inline double half_edge_of(const VoxelCube& cube, double resolution_m) {
    return 0.5 * (1U << cube.height) * resolution_m;
}

/// Centre of the cube, map frame, metres.
[[nodiscard]] inline Eigen::Vector3d centre_of(const VoxelCube& cube, double resolution_m) {
    const double half = 0.5 * (1U << cube.height);
    return resolution_m * Eigen::Vector3d(cube.lowest.x - kOriginKey + half,
                                          cube.lowest.y - kOriginKey + half,
                                          cube.lowest.z - kOriginKey + half);
}

}  // namespace octoskin
