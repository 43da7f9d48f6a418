// Answers a planner's query: whether a capsule, or a robot, is in free space.
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
    negative_radius,  ///< negative; 0 is a segment
    too_large,        ///< a coordinate or the radius exceeds 1e6 m: rounding would reach a nanometre
};

/// The worst state of the voxels that a capsule touches: occupied, then unknown, then free.
struct CapsuleAnswer {
    Occupancy state = Occupancy::free;
    /// The voxel of that state nearest to the capsule's axis, to a nanometre; of equals the first in Morton
    /// order. Empty for free, and if only space outside the octree is unknown.
    std::optional<VoxelKey> voxel;
    double distance_m = 0.0;  ///< from the axis to that voxel
};

/// A voxel is touched if its closed cube is no further from the axis than the radius. A cube further away by
/// less than a nanometre also counts as touched, so that rounding never makes a way free. Space outside the
/// octree is unknown. `capsule`: in the map frame. No allocation. The map may be a copy of a map that another
/// thread writes.
[[nodiscard]] Result<CapsuleAnswer, CapsuleFault> worst_in(const FusedMap& map,
                                                           const PosedCapsule& capsule) noexcept;

struct RefusedCapsule {
    std::size_t index = 0;
    CapsuleFault fault = CapsuleFault::not_finite;
};

/// The same for several capsules, with one answer each; `answers` is as long as `capsules` (asserted). If one
/// is refused, none is answered.
[[nodiscard]] Status<RefusedCapsule> worst_in(const FusedMap& map, std::span<const PosedCapsule> capsules,
                                              std::span<CapsuleAnswer> answers) noexcept;
/// True if all voxels that the capsules touch are free. Ends with the first voxel that is not.
[[nodiscard]] Result<bool, RefusedCapsule> is_free(const FusedMap& map,
                                                   std::span<const PosedCapsule> capsules) noexcept;

/// Distances from a capsule's surface to the nearest closed cubes, metres; 0 if it touches one.
struct CapsuleClearance {
    std::optional<double> occupied_m;  ///< empty: no occupied voxel is within reach
    std::optional<double> not_free_m;  ///< occupied, unknown, or outside the octree
};

/// Search distances, metres from the capsule's surface, 0 to 1e6 (else `too_large`). `not_free_m` is at most
/// `occupied_m`, because an occupied voxel is not free.
struct ClearanceReach {
    double occupied_m = 0.0;
    double not_free_m = 0.0;
};

/// Exact to a nanometre. The cost grows with the space within reach, and the search ends with the nearest
/// voxels: free space of 0.5 m takes about 10 us at 0.04 m resolution. No allocation.
[[nodiscard]] Result<CapsuleClearance, CapsuleFault> clearance(const FusedMap& map,
                                                               const PosedCapsule& capsule,
                                                               const ClearanceReach& reach) noexcept;
[[nodiscard]] inline Result<CapsuleClearance, CapsuleFault> clearance(const FusedMap& map,
                                                                      const PosedCapsule& capsule,
                                                                      double reach_m) noexcept {
    return clearance(map, capsule, ClearanceReach{reach_m, reach_m});
}

/// Why queries about the capsule are refused; empty if they are not.
[[nodiscard]] std::optional<CapsuleFault> fault_of(const PosedCapsule& capsule) noexcept;

/// For callers that know where to search (DistanceField): the search of a valid capsule, to which the caller
/// shows the near candidates, and its result.
[[nodiscard]] NearestSearch clearance_search(const FusedMap& map, const PosedCapsule& capsule,
                                             const ClearanceReach& reach) noexcept;
[[nodiscard]] CapsuleClearance clearance_reported(const NearestSearch& search, const FusedMap& map,
                                                  const PosedCapsule& capsule,
                                                  const ClearanceReach& reach) noexcept;

}  // namespace octoskin
