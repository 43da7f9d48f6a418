// A box of voxels, and the cube of an octree node.
#pragma once

#include <algorithm>

#include "host/core/voxels/voxel_lattice.hpp"

namespace octoskin {

/// Lowest and highest key along each axis, both included.
struct KeyBox {
    VoxelKey lowest;
    VoxelKey highest;

    void include(VoxelKey key) noexcept {
        lowest = {std::min(lowest.x, key.x), std::min(lowest.y, key.y), std::min(lowest.z, key.z)};
        highest = {std::max(highest.x, key.x), std::max(highest.y, key.y), std::max(highest.z, key.z)};
    }
};

/// The voxels whose keys equal `lowest` except in the low `height` bits, which are 0 in `lowest`: the cube of
/// an octree node, with 2^height voxels along each edge.
struct VoxelCube {
    VoxelKey lowest;
    unsigned height = 0;
};

/// True if they have a voxel in common.
[[nodiscard]] constexpr bool do_meet(const VoxelCube& cube, const KeyBox& box) noexcept {
    const int last = (1 << cube.height) - 1;
    const auto is_along = [last](int lowest, int box_lowest, int box_highest) {
        return lowest <= box_highest && lowest + last >= box_lowest;
    };
    return is_along(cube.lowest.x, box.lowest.x, box.highest.x) &&
           is_along(cube.lowest.y, box.lowest.y, box.highest.y) &&
           is_along(cube.lowest.z, box.lowest.z, box.highest.z);
}

}  // namespace octoskin
