// The free voxel with the least evidence that a capsule touches, and how much evidence a planner demands.
#pragma once

#include <optional>

#include "host/core/kinematics/capsule.hpp"
#include "host/core/mapping/free_evidence.hpp"
#include "host/core/mapping/fused_map.hpp"
#include "host/core/mapping/voxel_brick.hpp"

namespace octoskin {

struct WeakestFree {
    VoxelKey voxel;
    FreeEvidence evidence;
};

/// Free voxels with less evidence than `sum_min` count as unknown. A larger minimum never makes a query free.
struct FreeDemand {
    double sum_min = 0.0;  ///< FreeEvidence::sum(); 0: whatever the map calls free
    MissUnits units = {};  ///< of the mapping that made the map

    [[nodiscard]] bool is_met_by(const FreeEvidence& evidence) const noexcept {
        return evidence.sum() >= sum_min;
    }
};

/// The weakest free voxel that a capsule touches (in the sense of `worst_in`), by FreeEvidence::sum(); of
/// equals the first in Morton order. Empty if it touches no free voxel. `capsule`: finite, in the map frame.
/// Only voxels weaker than `than`, if given, are searched for. No allocation. About 5 us per capsule at 0.04
/// m.
[[nodiscard]] std::optional<WeakestFree> weakest_free_in(
    const FusedMap& map, const MissUnits& units, const PosedCapsule& capsule,
    const std::optional<WeakestFree>& than = {}) noexcept;

}  // namespace octoskin
