#include "host/core/pipeline/map_set.hpp"

#include <cassert>
#include <utility>

namespace octoskin {

MapSet::MapSet(const MapConfig& config, const MapChoice& choice) {
    if (choice.depth) {
        depth_.emplace(config);
    }
    if (choice.proximity) {
        proximity_.emplace(config);
    }
    if (choice.fused) {
        fused_.emplace(config);
    }
}

void MapSet::begin_with(FusedMap fused) {
    assert(fused_ && fused_->resolution_m() == fused.resolution_m());
    fused_ = std::move(fused);
}

void MapSet::limit_fused(const MapConfig& config) {
    assert(fused_);
    fused_->limit(config);
}

FusedMap MapSet::take_fused() {
    assert(fused_);
    return std::move(*fused_);
}

void MapSet::add_depth(const DepthTerms& terms) {
    for (auto* map : {&depth_, &fused_}) {
        if (*map) {
            (*map)->apply(terms);
        }
    }
}

void MapSet::add_proximity(std::span<const VoxelUpdate> updates) {
    for (auto* map : {&proximity_, &fused_}) {
        if (*map) {
            (*map)->apply(updates);
        }
    }
}

}  // namespace octoskin
