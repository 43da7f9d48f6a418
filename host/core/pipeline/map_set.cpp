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

void MapSet::forget_counts() noexcept {
    for (auto* map : {&depth_, &proximity_, &fused_}) {
        if (*map) {
            (*map)->forget_counts();
        }
    }
}

void MapSet::go_on(HostTime now) noexcept {
    for (auto* map : {&depth_, &proximity_, &fused_}) {
        if (*map) {
            (*map)->go_on(now);
        }
    }
}

void MapSet::leap(Nanoseconds by) noexcept {
    for (auto* map : {&depth_, &proximity_, &fused_}) {
        if (*map) {
            (*map)->leap(by);
        }
    }
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

void MapSet::add_proximity(const ConeVoxels& cone, const ConeModel& model, Blame blame) {
    count(cone, model, blame, nullptr);
}

std::vector<VoxelUpdate> MapSet::changes_of_proximity(const ConeVoxels& cone, const ConeModel& model,
                                                      Blame blame) {
    std::vector<VoxelUpdate> changes;
    count(cone, model, blame, &changes);
    return changes;
}

namespace {

/// Of a map that there is.
bool is_occupied_at(const std::optional<FusedMap>& map, const Eigen::Vector3d& p_map) noexcept {
    const auto key = map->key_of(p_map);
    return key && map->occupancy(*key) == Occupancy::occupied;
}

}  // namespace

void MapSet::mark(const ConeVoxels& cone, const Eigen::Vector3d& p_map, float hits,
                  std::vector<VoxelUpdate>* changes) {
    if (proximity_ && !is_occupied_at(proximity_, p_map)) {
        proximity_->mark(cone, hits);
    }
    if (fused_ && !is_occupied_at(fused_, p_map)) {
        fused_->mark(cone, hits, changes);
    }
}

bool MapSet::is_marked(const Eigen::Vector3d& p_map) const noexcept {
    return (!proximity_ || is_occupied_at(proximity_, p_map)) && (!fused_ || is_occupied_at(fused_, p_map));
}

void MapSet::forget_weak_hits(const ConeVoxels& cone, std::vector<VoxelUpdate>* changes) {
    if (proximity_) {
        proximity_->forget_weak_hits(cone);
    }
    if (fused_) {
        fused_->forget_weak_hits(cone, changes);
    }
}

void MapSet::clear(const ConeVoxels& cone, const std::function<bool(VoxelKey)>& is_ranged,
                   std::vector<VoxelUpdate>* changes) {
    if (proximity_) {
        proximity_->clear(cone, is_ranged);
    }
    if (fused_) {
        fused_->clear(cone, is_ranged, changes);
    }
}

void MapSet::count(const ConeVoxels& cone, const ConeModel& model, Blame blame,
                   std::vector<VoxelUpdate>* changes) {
    if (proximity_) {
        proximity_->apply(cone, model, blame);
    }
    if (fused_) {
        fused_->apply(cone, model, blame, changes);
    }
}

}  // namespace octoskin
