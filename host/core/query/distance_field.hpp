// How far every voxel of a region is from the nearest occupied and the nearest not-free one: a field that
// follows the map, for planners that ask often.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <optional>

#include "common/result.hpp"
#include "host/core/mapping/fused_map.hpp"
#include "host/core/query/brick_grid.hpp"
#include "host/core/query/capsule_query.hpp"
#include "host/core/query/distance_layer.hpp"
#include "host/core/query/nearest_search.hpp"

namespace octoskin {

/// Where a field tells distances, and how far it looks.
struct FieldExtent {
    Eigen::AlignedBox3d region;  ///< map frame, finite, not empty
    double reach_m = 0.0;        ///< above 0, and 120 voxels at most
};

/// Distances between voxel centres, exact, up to a reach. Holds a copy of the map that it tells of, which
/// costs what any copy does: while the map goes on, each brick that it writes is there twice.
///
/// Not safe for use by two threads at once, unless both only read.
class DistanceField {
  public:
    /// Of a map with nothing in it: all unknown. The region is rounded up to whole bricks and ends with the
    /// octree, the reach is rounded up to whole voxels; both as FieldExtent says (asserted). Half a metre
    /// beyond the largest radius of a capsule suits an arm. Throws std::bad_alloc.
    DistanceField(const MapConfig& map, const FieldExtent& extent);
    /// Bricks of which it keeps something, some 100 bytes each if there is nothing in the map, and up to
    /// 7 KiB (about what a surface in each makes of it).
    [[nodiscard]] static std::size_t bricks_of(const MapConfig& map, const FieldExtent& extent) noexcept;

    struct Update {
        std::size_t written = 0;  ///< bricks that the map wrote since the last update
        std::size_t changed = 0;  ///< in how many a voxel became, or ceased to be, occupied, or not free
        std::size_t worked = 0;   ///< layers of 64 voxels worked on, counted for each axis and both distances
    };
    /// The field of this map from now on: any map of the same resolution (asserted). O(bricks written), and
    /// some 0.1 us for each `worked`. Throws std::bad_alloc, and then the field is of no map: make another.
    Update update(const FusedMap& now);

    /// Metres between the centres of this voxel, one of the region (asserted), and the nearest occupied one;
    /// 0 if it is one. Empty: none is within `reach_m()`. About 10 ns.
    [[nodiscard]] std::optional<double> occupied_m(VoxelKey key) const noexcept;
    /// The same of the nearest that is occupied, unknown or outside the octree.
    [[nodiscard]] std::optional<double> not_free_m(VoxelKey key) const noexcept;
    [[nodiscard]] double reach_m() const noexcept { return reach_voxels_ * map_.resolution_m(); }

    /// Whether the capsule's axis is in the region.
    [[nodiscard]] bool tells_of(const PosedCapsule& capsule) const noexcept;
    /// The question of `octoskin::clearance()` and the same answer, to a nanometre. Quicker if the capsule's
    /// axis is in the region and `reach` ends within `axis_reach_m()` of it: the field says where to look.
    [[nodiscard]] Result<CapsuleClearance, CapsuleFault> clearance(
        const PosedCapsule& capsule, const ClearanceReach& reach) const noexcept;
    /// As far as the field tells.
    [[nodiscard]] Result<CapsuleClearance, CapsuleFault> clearance(
        const PosedCapsule& capsule) const noexcept;
    /// What is so near to a segment is near enough to a voxel that the segment passes.
    [[nodiscard]] double axis_reach_m() const noexcept;

    /// What it tells of.
    [[nodiscard]] const FusedMap& map() const noexcept { return map_; }
    [[nodiscard]] std::size_t memory_bytes() const noexcept {
        return occupied_.memory_bytes() + not_free_.memory_bytes() + sites_.memory_bytes();
    }

  private:
    class Samples;
    void take(const FusedMap& now, const MapBrick& brick, Update& update);
    void look_about(const Samples& samples, NearestSearch& search) const;
    /// Metres between centres.
    [[nodiscard]] std::optional<double> told_by(const DistanceLayer& layer, VoxelKey key) const noexcept;
    void look_at_nearest(const std::optional<VoxelKey>& site, NearestSearch& search) const;

    FusedMap map_;
    int reach_voxels_;
    BrickBox region_;
    DistanceLayer occupied_;
    DistanceLayer not_free_;
    /// Of the map: each brick that has an occupied voxel, and of those whose voxels are not alike each that
    /// has an unknown one.
    BrickGrid<BrickSites> sites_;
};

}  // namespace octoskin
