// Evidence written by tests: terms per voxel, and ranges of cones by their voxels.
#pragma once

#include <algorithm>
#include <functional>
#include <span>
#include <vector>

#include "host/core/mapping/cone_evidence.hpp"
#include "host/core/mapping/evidence.hpp"
#include "host/core/mapping/fused_map.hpp"
#include "tests/support/evidence.hpp"

namespace octoskin {

/// The terms of an image one by one, in Morton order.
inline std::vector<VoxelUpdate> updates_of(const Evidence& terms) {
    std::vector<VoxelUpdate> updates;
    for_each_term(terms, [&](const VoxelUpdate& update) { updates.push_back(update); });
    std::ranges::sort(updates, {}, [](const VoxelUpdate& update) { return morton_of(update.key); });
    return updates;
}

inline void feed(FusedMap& map, const Evidence& evidence) {
    map.apply(evidence);
}

inline void feed(FusedMap& map, std::span<const VoxelUpdate> updates, SensorKind sensor = SensorKind::range) {
    map.apply(evidence_of(updates, sensor));
}

inline void feed(FusedMap& map, const ConeVoxels& cone, const ConeModel& model, bool prefers_occupied = false,
                 std::vector<VoxelUpdate>* changes = nullptr) {
    Evidence evidence;
    make_counts(cone, model, prefers_occupied, evidence);
    map.apply(evidence, {.changes = changes});
}

inline void confirm(FusedMap& map, const ConeVoxels& cone, float hits,
                    std::vector<VoxelUpdate>* changes = nullptr) {
    Evidence evidence;
    make_confirmation(cone, hits, evidence);
    map.apply(evidence, {.changes = changes});
}

inline void withdraw(FusedMap& map, const ConeVoxels& cone, std::vector<VoxelUpdate>* changes = nullptr) {
    Evidence evidence;
    make_withdrawal(cone, evidence);
    map.apply(evidence, {.changes = changes});
}

inline void clear(FusedMap& map, const ConeVoxels& cone, const std::function<bool(VoxelKey)>& spares,
                  std::vector<VoxelUpdate>* changes = nullptr) {
    Evidence evidence;
    make_clearance(cone, evidence);
    map.apply(evidence, {.spares = &spares, .changes = changes});
}

}  // namespace octoskin
