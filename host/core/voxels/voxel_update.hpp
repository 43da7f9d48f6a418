// A value to be added to a voxel.
#pragma once

#include "host/core/voxels/voxel_lattice.hpp"

namespace octoskin {

/// One log-odds term for one voxel.
struct VoxelUpdate {
    VoxelKey key;
    float log_odds = 0.0F;
    friend bool operator==(const VoxelUpdate&, const VoxelUpdate&) = default;
};

}  // namespace octoskin
