// A planner's question to the map: is this capsule, or this robot, in free space?
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "common/result.hpp"
#include "host/core/kinematics/capsule.hpp"
#include "host/core/mapping/fused_map.hpp"
#include "host/core/query/nearest_search.hpp"

namespace octoskin {

enum class CapsuleFault : std::uint8_t {
    not_finite,       ///< an end or the radius
    negative_radius,  ///< 0 is a segment
    too_large,        ///< a coordinate or the radius is beyond 1e6 m: rounding would reach a nanometre
};

/// The worst of the voxels that a capsule touches: occupied, then unknown, then free.
struct CapsuleAnswer {
    Occupancy state = Occupancy::free;
    /// Which of that state is nearest to the capsule's axis, to a nanometre; of equals the first in Morton
    /// order. Empty for free, and if nothing but space outside the octree is unknown.
    std::optional<VoxelKey> voxel;
    double distance_m = 0.0;  ///< from the axis to that voxel
};

/// A voxel is touched if its closed cube is no further from the axis than the radius; what is further by
/// less than a nanometre counts as touched, so that rounding never makes a way free. Space outside the octree
/// is unknown. `capsule`: in the map frame. No allocation; the map may be a copy of one that another thread
/// writes.
[[nodiscard]] Result<CapsuleAnswer, CapsuleFault> worst_in(const FusedMap& map,
                                                           const PosedCapsule& capsule) noexcept;

struct RefusedCapsule {
    std::size_t index = 0;
    CapsuleFault fault = CapsuleFault::not_finite;
};

/// The same of several capsules, one answer each; `answers` is as long as `capsules` (asserted). If one is
/// refused, none is answered.
[[nodiscard]] Status<RefusedCapsule> worst_in(const FusedMap& map, std::span<const PosedCapsule> capsules,
                                              std::span<CapsuleAnswer> answers) noexcept;
/// Whether all that they touch is free: ends with the first voxel that is not.
[[nodiscard]] Result<bool, RefusedCapsule> is_free(const FusedMap& map,
                                                   std::span<const PosedCapsule> capsules) noexcept;

/// How far a capsule's surface is from the nearest closed cubes, metres; 0 if it touches one.
struct CapsuleClearance {
    std::optional<double> occupied_m;  ///< empty: no occupied voxel is within reach
    std::optional<double> not_free_m;  ///< occupied, unknown, or outside the octree
};

/// Up to where something is looked for, metres from the capsule's surface, 0 to 1e6 (else `too_large`).
/// `not_free_m` is no more than the other: what is occupied is not free.
struct ClearanceReach {
    double occupied_m = 0.0;
    double not_free_m = 0.0;
};

/// Exact to a nanometre. The cost grows with the space within reach and ends with what is found: what is free
/// up to 0.5 m takes some 10 us at 0.04 m. No allocation.
[[nodiscard]] Result<CapsuleClearance, CapsuleFault> clearance(const FusedMap& map,
                                                               const PosedCapsule& capsule,
                                                               const ClearanceReach& reach) noexcept;
[[nodiscard]] inline Result<CapsuleClearance, CapsuleFault> clearance(const FusedMap& map,
                                                                      const PosedCapsule& capsule,
                                                                      double reach_m) noexcept {
    return clearance(map, capsule, ClearanceReach{reach_m, reach_m});
}

/// Why no question about the capsule can be answered; empty if one can.
[[nodiscard]] std::optional<CapsuleFault> fault_of(const PosedCapsule& capsule) noexcept;

/// For whoever knows where to look (DistanceField): the search of a capsule that is no fault, to be shown
/// what may be near, and what it then tells.
[[nodiscard]] NearestSearch clearance_search(const FusedMap& map, const PosedCapsule& capsule,
                                             const ClearanceReach& reach) noexcept;
[[nodiscard]] CapsuleClearance clearance_told(const NearestSearch& search, const FusedMap& map,
                                              const PosedCapsule& capsule,
                                              const ClearanceReach& reach) noexcept;

}  // namespace octoskin
