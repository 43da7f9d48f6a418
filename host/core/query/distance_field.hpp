// How far every voxel of a map is from the nearest occupied and the nearest not-free one: a field that
// follows the map, for planners that ask often.
#pragma once

#include <cstddef>
#include <optional>

#include "common/result.hpp"
#include "host/core/mapping/fused_map.hpp"
#include "host/core/query/capsule_query.hpp"
#include "host/core/query/distance_layer.hpp"
#include "host/core/query/nearest_search.hpp"

namespace octoskin {

/// Distances between voxel centres, exact, up to a reach. Holds a copy of the map that it tells of, which
/// costs what any copy does: while the map goes on, each brick that it writes is there twice.
///
/// Not safe for use by two threads at once, unless both only read.
class DistanceField {
  public:
    /// Of a map with nothing in it: all unknown. `reach_m`: above 0, and 120 voxels at most (asserted); it is
    /// rounded up to whole voxels. Half a metre beyond the largest radius of a capsule suits an arm.
    DistanceField(const MapConfig& map, double reach_m);

    struct Update {
        std::size_t written = 0;  ///< bricks that the map wrote since the last update
        std::size_t changed = 0;  ///< in how many a voxel became, or ceased to be, occupied, or not free
        std::size_t worked = 0;   ///< bricks that were worked on, counted for each axis and both distances
    };
    /// The field of this map from now on: any map of the same resolution (asserted). O(bricks written), and
    /// about 1 us for each `worked` at 0.04 m. Throws std::bad_alloc, and then the field is of no map: make
    /// another.
    Update update(const FusedMap& now);

    /// Metres between the centres of this voxel and the nearest occupied one; 0 if it is one. Empty: none is
    /// within `reach_m()`. About 20 ns.
    [[nodiscard]] std::optional<double> occupied_m(VoxelKey key) const noexcept;
    /// The same of the nearest that is occupied, unknown or outside the octree.
    [[nodiscard]] std::optional<double> not_free_m(VoxelKey key) const noexcept;
    [[nodiscard]] double reach_m() const noexcept { return reach_voxels_ * map_.resolution_m(); }

    /// The question of `octoskin::clearance()` and the same answer, to a nanometre: the field says how far to
    /// look. Found is what is no further from the capsule's axis than `axis_reach_m()`.
    [[nodiscard]] Result<CapsuleClearance, CapsuleFault> clearance(
        const PosedCapsule& capsule) const noexcept;
    /// What is so near to a segment is near enough to a voxel that the segment passes.
    [[nodiscard]] double axis_reach_m() const noexcept;

    /// What it tells of.
    [[nodiscard]] const FusedMap& map() const noexcept { return map_; }
    [[nodiscard]] std::size_t memory_bytes() const noexcept {
        constexpr std::size_t kEntry = sizeof(SiteMap::value_type) + 32;  // about
        return occupied_.memory_bytes() + not_free_.memory_bytes() + sites_.size() * kEntry;
    }

  private:
    struct Bounds {
        std::optional<double> occupied_m;  ///< from the axis; empty: none is within `axis_reach_m()`
        std::optional<double> not_free_m;
    };
    [[nodiscard]] std::optional<Bounds> bounds_along(const PosedCapsule& capsule) const noexcept;

    int reach_voxels_;
    FusedMap map_;
    SiteMap sites_;  ///< of the map
    DistanceLayer occupied_;
    DistanceLayer not_free_;
};

}  // namespace octoskin
