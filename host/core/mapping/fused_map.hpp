// The map: occupied, free and unknown space in log-odds, in the map frame, with OctoMap's keys and
// arithmetic. VoxelRules defines the effect of a measurement. Files and octomap::OcTree: host/io/mapfile.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "common/time.hpp"
#include "host/core/mapping/evidence.hpp"
#include "host/core/mapping/map_config.hpp"
#include "host/core/mapping/map_counters.hpp"
#include "host/core/mapping/map_layers.hpp"
#include "host/core/mapping/voxel_rules.hpp"
#include "host/core/voxels/key_box.hpp"
#include "host/core/voxels/voxel_lattice.hpp"

namespace octoskin {

class BrickEditor;

/// A brick of a map; valid while the map exists and is unchanged.
struct MapBrick {
    MortonCode first = 0;  ///< code of its first voxel
    BrickView log_odds;    ///< of its voxels in Morton order; NaN: unknown
};

/// Not safe for concurrent use by two threads, unless all of them only read. A copy may be passed to another
/// thread.
class FusedMap {
  public:
    /// Resolution finite and positive; other values as for VoxelRules (asserted).
    explicit FusedMap(const MapConfig& config);
    /// Continues with the layers of another map of this configuration, from a snapshot; the caller has
    /// checked them. `has_undated`: of that map. O(1).
    FusedMap(const MapConfig& config, MapLayers layers, bool has_undated);
    FusedMap(FusedMap&&) noexcept = default;
    FusedMap& operator=(FusedMap&&) noexcept = default;

    /// A snapshot. O(1), never throws. Bricks that both maps hold are copied when this map writes them.
    [[nodiscard]] FusedMap copy() const noexcept { return FusedMap(*this); }
    /// Visits, in Morton order, each brick in which this map may differ from `before`, an earlier copy of it.
    /// For unrelated maps, visits each brick of both. O(bricks written since).
    void for_each_difference(const FusedMap& before,
                             const std::function<void(const MapBrick& now)>& visit) const;

    /// Applies the evidence voxel by voxel, in order. Refused voxels are counted, and the next one is tried.
    /// Throws only because of EvidenceOptions. About 5 ns a voxel, 25 ns where there are counts.
    void apply(const Evidence& evidence, const EvidenceOptions& options = {});
    /// Advances the map's time to the capture time of what is applied next. A map without a time gives voxels
    /// no time stamp; voxels from before its time begins are stale until a sensor sees them. Voxels that no
    /// sensor has seen for `age.unknown_after_s` expire at the next whole second. O(1) within a second. In a
    /// new second, if voxels expire, visits a 64th of the bricks and those that may have voxels that are too
    /// old: about 50 us for 10,000 bricks. The first time visits all bricks.
    void advance_time(HostTime now) noexcept;
    /// Time jump: from now on, times are from a clock that is ahead of the earlier one by `by` (behind, if
    /// negative). No age changes.
    void jump_time(Nanoseconds by) noexcept { layers_.ages.jump_time(by); }
    /// For a map that was saved, or that was built before the machine slept: the next time is on another
    /// scale, and until then `wait` reports how much time has passed. In a map without a time, the time
    /// begins here, and voxels without a time stamp get one when the time advances. O(1).
    void begin_to_wait() noexcept;
    /// `seconds` in total have passed since `begin_to_wait`: every age grows by the part that was not added
    /// before, and voxels that are too old expire. True if ages grew. False if the map does not wait, or if
    /// there is no memory; a later call then adds the time. Same cost as `advance_time`.
    bool wait(std::int64_t seconds) noexcept;
    /// The ages are no longer known: all voxels count as measured before the map's time began. The time
    /// restarts and waits as after `begin_to_wait`, and voxels are stale until a sensor sees them. O(time
    /// stamps).
    void clear_times() noexcept;
    /// Applies other limits at the same resolution (asserted). Log-odds beyond new clamps are clamped; bricks
    /// beyond a smaller memory limit stay. If voxels did not expire before and now do, counts without a time
    /// stamp are treated as from before the map's time. The map's counters restart. O(voxels) if the clamps
    /// change. Throws std::bad_alloc if the clamps or the counts' model change and there is no memory for a
    /// second copy of all voxels; nothing is changed then.
    void limit(const MapConfig& config);
    /// Clears the counts of range sensors in the voxels of `terms`. Throws std::bad_alloc.
    void clear_counts_of(const Evidence& terms);
    /// Sets every voxel of a cube to this value, clamped; for building a map from a file. False if there was
    /// no room (part of the cube may then be set) or if the value is not finite.
    [[nodiscard]] bool set_cube(const VoxelCube& cube, float log_odds);

    [[nodiscard]] Occupancy occupancy(VoxelKey key) const noexcept;
    [[nodiscard]] Occupancy occupancy_of(float log_odds) const noexcept { return rules_.occupancy(log_odds); }
    /// Empty for unknown.
    [[nodiscard]] std::optional<float> log_odds(VoxelKey key) const noexcept;
    /// When and by which kind of sensor a known voxel was last seen; empty if unknown.
    [[nodiscard]] std::optional<Confirmation> confirmation(VoxelKey key) const noexcept;
    /// True for a known voxel that no sensor has seen for `age.stale_after_s`, or whose age is unknown.
    /// Always false if the map has no time.
    [[nodiscard]] bool is_stale(VoxelKey key) const noexcept;
    /// Known voxels with a time stamp below this one are stale; 0 if none can be.
    [[nodiscard]] std::uint16_t stale_stamp() const noexcept;

    [[nodiscard]] const MapConfig& config() const noexcept { return config_; }
    [[nodiscard]] const VoxelLattice& lattice() const noexcept { return lattice_; }
    [[nodiscard]] double resolution_m() const noexcept { return config_.resolution_m; }
    [[nodiscard]] const MapCounters& counters() const noexcept { return counters_; }
    [[nodiscard]] const MapLayers& layers() const noexcept { return layers_; }
    /// True if some voxels from before the clock began still have no time stamp.
    [[nodiscard]] bool has_undated() const noexcept { return has_undated_; }
    /// The voxel that contains a point of the map frame. Empty for a point that is not finite or outside the
    /// octree.
    [[nodiscard]] std::optional<VoxelKey> key_of(const Eigen::Vector3d& p_map) const noexcept;
    [[nodiscard]] Eigen::Vector3d centre_of(VoxelKey key) const noexcept;
    [[nodiscard]] std::size_t known_voxels() const noexcept { return layers_.known_voxels; }
    /// The number that a copy has after `advance_time(now)`. O(1) unless a second has passed and voxels
    /// expire; then about 0.1 us for each brick.
    [[nodiscard]] std::size_t known_voxels_at(HostTime now) const;
    /// Upper bound of the heap bytes for the map's log-odds, limited by `MapConfig::memory_max_mib`.
    [[nodiscard]] std::size_t memory_bytes() const noexcept;
    /// Heap bytes of all layers now. Bricks with equal voxels take very little.
    [[nodiscard]] std::size_t heap_bytes() const noexcept { return layers_.heap_bytes(); }

    /// Visits every known voxel once, in Morton order (an octree's depth-first order), independent of the
    /// order in which the map was filled. O(voxels).
    void for_each_known(const std::function<void(VoxelKey, float log_odds)>& visit) const;
    /// All bricks of the map, in Morton order. O(bricks).
    [[nodiscard]] std::vector<MapBrick> bricks() const;
    /// The brick with this first voxel; it may be unknown. Valid while the brick is unchanged.
    [[nodiscard]] BrickView brick(MortonCode first) const noexcept { return layers_.log_odds.find(first); }
    /// The whole octree, for descending from large cubes to small ones. Valid while the map is unchanged.
    [[nodiscard]] BrickTree::Space space() const noexcept { return layers_.log_odds.space(); }

  private:
    FusedMap(const FusedMap&) noexcept = default;
    [[nodiscard]] BrickEditor editor() noexcept;
    /// Call in a new second. Throws std::bad_alloc; the rest then follows in a later second.
    void date_and_expire();

    MapConfig config_;
    VoxelLattice lattice_;
    VoxelRules rules_;
    MapCounters counters_;
    MapLayers layers_;
    bool has_undated_ = false;
};

}  // namespace octoskin
