// What an answer rests on: how long ago, and by what, the space was measured that the robot would take.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "host/core/kinematics/capsule.hpp"
#include "host/core/mapping/fused_map.hpp"

namespace octoskin {

[[nodiscard]] std::string_view name(SensorKind kind) noexcept;

/// The voxel of several that was confirmed the longest ago; of equals the one that a weaker kind confirmed.
struct WeakestEvidence {
    VoxelKey voxel;
    std::optional<Confirmation> confirmation;  ///< empty: nobody knows, which is weaker than all
    bool is_stale = false;                     ///< FusedMap::is_stale
    std::uint16_t stamp = 0;                   ///< the less, the weaker
};

/// Of the known voxels that a capsule touches, in the sense of `worst_in`; empty if it touches none, and of a
/// map that was never told the time. `capsule`: finite, in the map frame. Only what is weaker than `than`, if
/// there is something, is looked for: asked of several capsules, most of the space is passed over. No
/// allocation. About 5 us a capsule at 0.04 m.
[[nodiscard]] std::optional<WeakestEvidence> weakest_in(
    const FusedMap& map, const PosedCapsule& capsule,
    const std::optional<WeakestEvidence>& than = {}) noexcept;

}  // namespace octoskin
