#include "host/core/pipeline/map_feeder.hpp"

#include <algorithm>
#include <utility>

namespace octoskin {

void MapFeeder::apply(const Evidence& evidence, const std::function<bool(VoxelKey)>* spares) {
    if (!has_begun_) {
        for (FedMap& fed : maps_) fed.map.advance_time(now_);
        if (listener_ != nullptr) listener_->on_time(now_, maps_);
    }
    std::vector<VoxelUpdate> changes;
    for (FedMap& fed : maps_) {
        if (!fed.takes(evidence.sensor)) continue;
        const bool is_listed = changes_ != nullptr && fed.feed == MapFeed::both;
        fed.map.apply(evidence, {.spares = spares, .changes = is_listed ? &changes : nullptr});
    }
    const bool is_first = !std::exchange(has_begun_, true);
    if (changes_ == nullptr) return;
    if (evidence.rule == EvidenceRule::terms)
        for_each_term(evidence, [&](const VoxelUpdate& term) { changes.push_back(term); });
    // The first evidence has most of the voxels, and each of them once.
    if (is_first) return changes_->swap(changes);
    for (const VoxelUpdate& change : changes) add_change(change);
}

void MapFeeder::add_change(const VoxelUpdate& change) {
    const auto same = std::ranges::find(*changes_, change.key, &VoxelUpdate::key);
    if (same != changes_->end()) {
        same->log_odds += change.log_odds;
    } else {
        changes_->push_back(change);
    }
}

bool MapFeeder::is_occupied(VoxelKey key) const {
    return std::ranges::all_of(maps_, [&](const FedMap& fed) {
        return !fed.takes(SensorKind::range) || fed.map.occupancy(key) == Occupancy::occupied;
    });
}

}  // namespace octoskin
