// A voxel's state, from the layers of the map that hold its parts.
#pragma once

#include <cstddef>

#include "host/core/bricks/brick.hpp"
#include "host/core/mapping/map_layers.hpp"
#include "host/core/mapping/voxel_rules.hpp"

namespace octoskin {

/// A brick's voxels in all layers but the time stamps. Valid while the map is unchanged.
struct VoxelBrick {
    BrickView log_odds;
    BrickView prior;
    BrickView hits{nullptr, 0.0F};
    BrickView misses{nullptr, 0.0F};
    bool has_counts = false;

    [[nodiscard]] VoxelState at(std::size_t cell) const noexcept {
        return {log_odds.at(cell), prior.at(cell), hits.at(cell), misses.at(cell)};
    }
};
/// `first`: code of the brick's first voxel; `log_odds`: the layer's brick there.
[[nodiscard]] VoxelBrick voxel_brick(const MapLayers& layers, MortonCode first,
                                     const BrickView& log_odds) noexcept;
[[nodiscard]] VoxelState voxel_state(const MapLayers& layers, VoxelKey key) noexcept;

}  // namespace octoskin
