// Storage of a map: one octree of bricks for each kind of value. Only a BrickEditor writes them.
#pragma once

#include <cstddef>

#include "host/core/bricks/brick_tree.hpp"
#include "host/core/mapping/count_layer.hpp"
#include "host/core/mapping/voxel_ages.hpp"

namespace octoskin {

/// VoxelState::log_odds of all voxels, the rest of VoxelState where there are counts, and when each voxel was
/// last seen. Without counts, a voxel's log-odds are its prior. Copies share unchanged bricks.
struct MapLayers {
    BrickTree log_odds;
    CountLayer counts;
    VoxelAges ages;
    std::size_t known_voxels = 0;

    [[nodiscard]] std::size_t heap_bytes() const noexcept {
        return log_odds.memory_bytes() + counts.heap_bytes() + ages.heap_bytes();
    }
};

}  // namespace octoskin
