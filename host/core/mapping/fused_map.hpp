// The map: occupied, free and unknown space in log-odds, in the map frame, with OctoMap's keys and
// arithmetic. VoxelRules says what a measurement does to it. Files and octomap::OcTree: host/io/mapfile.
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

/// A brick of a map, for as long as that is there and unchanged.
struct MapBrick {
    MortonCode first = 0;  ///< of its voxels
    BrickView log_odds;    ///< of its voxels in Morton order; NaN: unknown
};

/// Not safe for use by two threads at once, unless all of them only read; a copy may go to another thread.
class FusedMap {
  public:
    /// Resolution finite and positive; the rest as VoxelRules (asserted).
    explicit FusedMap(const MapConfig& config);
    /// Goes on with the layers of another map of this configuration, as a snapshot holds them; the caller has
    /// checked them. `has_undated`: of that map. O(1).
    FusedMap(const MapConfig& config, MapLayers layers, bool has_undated);
    FusedMap(FusedMap&&) noexcept = default;
    FusedMap& operator=(FusedMap&&) noexcept = default;

    /// A snapshot. O(1), and never throws; what this map writes from then on it first copies, brick by brick,
    /// if both still hold it.
    [[nodiscard]] FusedMap copy() const noexcept { return FusedMap(*this); }
    /// Visits, in Morton order, each brick in which this map may differ from `before`, an earlier copy of it;
    /// of a map that has nothing in common with it, each brick of both. O(what was written since).
    void for_each_difference(const FusedMap& before,
                             const std::function<void(const MapBrick& now)>& visit) const;

    /// Does what the evidence says, voxel by voxel, in order. What is refused is counted, and the next voxel
    /// is tried. Never throws but for EvidenceOptions. Some 5 ns a voxel, 25 ns where there are counts.
    void apply(const Evidence& evidence, const EvidenceOptions& options = {});
    /// Time goes on, to when what is applied next was measured. A map without a time dates no voxel; what is
    /// there when its time begins is stale until a sensor sees it. What no sensor has seen for
    /// `age.unknown_after_s` expires at the next whole second. O(1) within a second; in a new one, if voxels
    /// expire, a 64th of the bricks are looked at and those that may have voxels that are too old: some 50 us
    /// for 10,000 bricks, and all of them the first time.
    void go_on(HostTime now) noexcept;
    /// The clock by which times come from now on is ahead by this of the one before (or behind, below 0):
    /// nothing has become older.
    void leap(Nanoseconds by) noexcept { layers_.ages.leap(by); }
    /// A map that was saved, or that is of before the machine slept: what comes next has times of another
    /// scale, and until then `wait` says what has passed. The time of a map without one begins
    /// with that, and what has no time is dated when time goes on. O(1).
    void begin_to_wait() noexcept;
    /// So many seconds have passed since `begin_to_wait`, in all: every age grows by what was not added yet,
    /// and what is too old expires. True if ages grew; false if the map does not wait, and if there is no
    /// memory for that: a later call adds it. Costs as `go_on`.
    bool wait(std::int64_t seconds) noexcept;
    /// How long ago anything was seen is not known any more: everything is as of before the map's time, which
    /// begins anew and waits as with `begin_to_wait`, and stale until a sensor sees it. O(stamps).
    void forget_times() noexcept;
    /// From now on other limits hold, at the same resolution (asserted): what lies beyond new clamps is
    /// clamped; bricks beyond a smaller memory stay. Where voxels are to expire from now on, counts that have
    /// no time are as of before the map's time. The counters begin anew. O(voxels) if the
    /// clamps change. Throws std::bad_alloc if there is no memory for as many voxels once more, if the clamps
    /// or the counts' model change; then nothing is changed.
    void limit(const MapConfig& config);
    /// What range sensors counted in the voxels of `terms` is forgotten. Throws std::bad_alloc.
    void forget_counts_of(const Evidence& terms);
    /// Gives every voxel of a cube this value, clamped; for building a map from a file. False if there was no
    /// room (then part of the cube may be set) or the value is not finite.
    [[nodiscard]] bool set_cube(const VoxelCube& cube, float log_odds);

    [[nodiscard]] Occupancy occupancy(VoxelKey key) const noexcept;
    [[nodiscard]] Occupancy occupancy_of(float log_odds) const noexcept { return rules_.occupancy(log_odds); }
    /// Empty for unknown.
    [[nodiscard]] std::optional<float> log_odds(VoxelKey key) const noexcept;
    /// When and by what a known voxel was last seen; empty for an unknown one and where that is not known.
    [[nodiscard]] std::optional<Confirmation> confirmation(VoxelKey key) const noexcept;
    /// A known voxel that no sensor has seen for `age.stale_after_s`, or of which that is not known. None is
    /// if the map has no time.
    [[nodiscard]] bool is_stale(VoxelKey key) const noexcept;
    /// Known voxels with a stamp below this one are stale; 0 if none can be.
    [[nodiscard]] std::uint16_t stale_stamp() const noexcept;

    [[nodiscard]] const MapConfig& config() const noexcept { return config_; }
    [[nodiscard]] const VoxelLattice& lattice() const noexcept { return lattice_; }
    [[nodiscard]] double resolution_m() const noexcept { return config_.resolution_m; }
    [[nodiscard]] const MapCounters& counters() const noexcept { return counters_; }
    [[nodiscard]] const MapLayers& layers() const noexcept { return layers_; }
    /// Whether what was there when the clock began has not all been dated.
    [[nodiscard]] bool has_undated() const noexcept { return has_undated_; }
    /// The voxel that holds a point of the map frame; empty for a point that is not finite or outside the
    /// octree.
    [[nodiscard]] std::optional<VoxelKey> key_of(const Eigen::Vector3d& p_map) const noexcept;
    [[nodiscard]] Eigen::Vector3d centre_of(VoxelKey key) const noexcept;
    [[nodiscard]] std::size_t known_voxels() const noexcept { return layers_.known_voxels; }
    /// What the map's space may come to take of the heap, of `MapConfig::memory_max_mib`.
    [[nodiscard]] std::size_t memory_bytes() const noexcept;
    /// What all layers take now. Space whose voxels are alike takes next to nothing.
    [[nodiscard]] std::size_t heap_bytes() const noexcept { return layers_.heap_bytes(); }

    /// Visits every known voxel once, in Morton order (an octree's depth-first order), whatever the order in
    /// which the map was filled. O(voxels).
    void for_each_known(const std::function<void(VoxelKey, float log_odds)>& visit) const;
    /// All of the space that the map takes, in Morton order. O(bricks).
    [[nodiscard]] std::vector<MapBrick> bricks() const;
    /// The brick whose first voxel this is, for as long as it is unchanged; it need not be known.
    [[nodiscard]] BrickView brick(MortonCode first) const noexcept { return layers_.log_odds.find(first); }
    /// All of the octree, to be followed from large cubes to small ones; for as long as the map is unchanged.
    [[nodiscard]] BrickTree::Space space() const noexcept { return layers_.log_odds.space(); }

  private:
    FusedMap(const FusedMap&) noexcept = default;
    [[nodiscard]] BrickEditor editor() noexcept;
    /// In a new second. Throws std::bad_alloc: what is left then is found in a later second.
    void date_and_expire();

    MapConfig config_;
    VoxelLattice lattice_;
    VoxelRules rules_;
    MapCounters counters_;
    MapLayers layers_;
    bool has_undated_ = false;
};

}  // namespace octoskin
