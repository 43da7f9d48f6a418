// Distances from each voxel of a region to the nearest occupied and the nearest not-free voxel. The field
// follows the map, for planners with frequent queries.
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

/// The region in which a field has distances, and their limit.
struct FieldExtent {
    Eigen::AlignedBox3d region;  ///< map frame, finite, not empty
    double reach_m = 0.0;        ///< above 0, and 120 voxels at most
};

/// Exact distances between voxel centres, up to a reach. The field keeps a copy of its map; as with any copy,
/// each brick that the original writes later exists twice.
///
/// Two threads must not use it at the same time, unless both only read.
class DistanceField {
  public:
    /// Starts with an empty map: all unknown. The region is rounded up to whole bricks and limited by the
    /// octree; the reach is rounded up to whole voxels. Both must be as FieldExtent requires (asserted). A
    /// reach of half a metre more than the largest capsule radius suits an arm. Throws std::bad_alloc.
    DistanceField(const MapConfig& map, const FieldExtent& extent);
    /// Number of bricks for which the field has data: about 100 bytes each for an empty map, and up to 7 KiB
    /// (about the amount with a surface in each brick).
    [[nodiscard]] static std::size_t bricks_of(const MapConfig& map, const FieldExtent& extent) noexcept;

    struct Update {
        std::size_t written = 0;  ///< bricks that the map wrote since the last update
        std::size_t changed = 0;  ///< bricks in which a voxel became, or ceased to be, occupied or not free
        std::size_t worked = 0;   ///< layers of 64 voxels worked on, counted for each axis and both distances
    };
    /// Makes this the field of `now`, any map of the same resolution (asserted). O(bricks written), plus
    /// about 0.1 us for each `worked`. Throws std::bad_alloc; the field is then invalid and must be replaced.
    Update update(const FusedMap& now);

    /// Distance in metres from the centre of this voxel, which must be in the region (asserted), to that of
    /// the nearest occupied voxel; 0 if it is occupied. Empty: none within `reach_m()`. About 10 ns.
    [[nodiscard]] std::optional<double> occupied_m(VoxelKey key) const noexcept;
    /// The same for the nearest voxel that is occupied, unknown or outside the octree.
    [[nodiscard]] std::optional<double> not_free_m(VoxelKey key) const noexcept;
    [[nodiscard]] double reach_m() const noexcept { return reach_voxels_ * map_.resolution_m(); }

    /// True if the capsule's axis is in the region.
    [[nodiscard]] bool tells_of(const PosedCapsule& capsule) const noexcept;
    /// The same query and answer as `octoskin::clearance()`, to a nanometre. Faster if the capsule's axis is
    /// in the region and `reach` ends within `axis_reach_m()` of it, because the field shows where to search.
    [[nodiscard]] Result<CapsuleClearance, CapsuleFault> clearance(
        const PosedCapsule& capsule, const ClearanceReach& reach) const noexcept;
    /// As above, up to the field's limit.
    [[nodiscard]] Result<CapsuleClearance, CapsuleFault> clearance(
        const PosedCapsule& capsule) const noexcept;
    /// A voxel within this distance of a segment is within the field's reach of a voxel on the segment.
    [[nodiscard]] double axis_reach_m() const noexcept;

    /// The map of the field.
    [[nodiscard]] const FusedMap& map() const noexcept { return map_; }
    [[nodiscard]] std::size_t memory_bytes() const noexcept {
        return occupied_.memory_bytes() + not_free_.memory_bytes() + sites_.memory_bytes();
    }

  private:
    class Samples;
    void take(const FusedMap& now, const MapBrick& brick, Update& update);
    void look_about(const Samples& samples, NearestSearch& search) const;
    /// Distance between centres, metres.
    [[nodiscard]] std::optional<double> distance_by(const DistanceLayer& layer, VoxelKey key) const noexcept;
    void look_at_nearest(const std::optional<VoxelKey>& site, NearestSearch& search) const;

    FusedMap map_;
    int reach_voxels_;
    BrickBox region_;
    DistanceLayer occupied_;
    DistanceLayer not_free_;
    /// The map's bricks with an occupied voxel, and its dense bricks with an unknown voxel.
    BrickGrid<BrickSites> sites_;
};

}  // namespace octoskin
