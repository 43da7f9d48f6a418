#include "host/core/mapping/voxel_brick.hpp"

namespace octoskin {

VoxelBrick voxel_brick(const MapLayers& layers, MortonCode first, const BrickView& log_odds) noexcept {
    VoxelBrick brick{.log_odds = log_odds, .prior = log_odds};
    if (!layers.counts.has(first)) return brick;
    brick.prior = layers.counts.prior.find(first);
    brick.hits = layers.counts.hits.find(first);
    brick.misses = layers.counts.misses.find(first);
    brick.has_counts = true;
    return brick;
}

VoxelState voxel_state(const MapLayers& layers, VoxelKey key) noexcept {
    const MortonCode first = brick_of(key);
    return voxel_brick(layers, first, layers.log_odds.find(first)).at(cell_of(key));
}

}  // namespace octoskin
