// The map: occupied, free and unknown space in log-odds, in the map frame, with OctoMap's keys and
// arithmetic. The only type of the mapping room that others hold. Files and octomap::OcTree: host/io/mapfile.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "common/result.hpp"
#include "host/core/bricks/brick_terms.hpp"
#include "host/core/bricks/brick_tree.hpp"
#include "host/core/mapping/depth_terms.hpp"
#include "host/core/voxels/key_box.hpp"
#include "host/core/voxels/morton.hpp"
#include "host/core/voxels/voxel_lattice.hpp"

namespace octoskin {

enum class Occupancy : std::uint8_t { unknown, free, occupied };

struct MapConfig {
    double resolution_m = 0.04;
    float log_odds_min = -2.0F;
    float log_odds_max = 3.5F;
    /// A voxel is occupied at or above this log-odds.
    float log_odds_occupied = 0.0F;
    /// Beyond this the map takes no new space; what it holds goes on being updated. Space counts as if each
    /// of its voxels had a value of its own, for each may come to have one.
    std::uint32_t memory_max_mib = 800;
    friend bool operator==(const MapConfig&, const MapConfig&) = default;
};

/// What became of every update ever given to a map: in = the sum of these.
struct MapCounters {
    std::uint64_t applied = 0;
    std::uint64_t zero = 0;        ///< a term of 0 touches nothing
    std::uint64_t not_finite = 0;  ///< refused
    std::uint64_t no_room = 0;     ///< refused: the voxel's space is new, and `memory_max_mib` is reached
    std::uint64_t no_memory = 0;   ///< refused: the voxel's space is new, and the system has no memory for it
    friend bool operator==(const MapCounters&, const MapCounters&) = default;
};

/// A brick of a map, for as long as that is there and unchanged.
struct MapBrick {
    MortonCode first = 0;  ///< of its voxels
    BrickView log_odds;    ///< of its voxels in Morton order; NaN: unknown
};

/// Not safe for use by two threads at once, unless all of them only read; a copy may go to another thread.
class FusedMap {
  public:
    /// Resolution finite and positive, log_odds_min <= 0 <= log_odds_max, both finite (asserted).
    explicit FusedMap(const MapConfig& config);
    FusedMap(FusedMap&&) noexcept = default;
    FusedMap& operator=(FusedMap&&) noexcept = default;

    /// The same map again, for whoever shall look at it while this one goes on: a snapshot. O(1), and never
    /// throws; what this map writes from then on it first copies, brick by brick, if both still hold it.
    [[nodiscard]] FusedMap copy() const noexcept { return FusedMap(*this); }
    /// Visits, in Morton order, each brick in which this map may differ from `before`, an earlier copy of it.
    /// O(what was written since).
    void for_each_difference(const FusedMap& before,
                             const std::function<void(const MapBrick& now)>& visit) const;

    /// From now on other limits hold, at the same resolution (asserted): what lies beyond new clamps is
    /// clamped; bricks beyond a smaller memory stay. The counters begin anew. O(voxels) if the clamps change.
    /// Throws std::bad_alloc if a copy holds the voxels, too, and there is no memory for others; then nothing
    /// is changed.
    void limit(const MapConfig& config);

    /// Adds each term to its voxel (unknown counts as 0 before) and clamps, one by one, in order, in
    /// OctoMap's single precision. A term of 0 touches nothing: in OctoMap a node at log-odds 0 counts as
    /// occupied. A term that is not finite is refused and counted, as is one for space that cannot be had:
    /// the next one is tried again. Never throws. About 5 ns an update if neighbours come together.
    void apply(std::span<const VoxelUpdate> updates);
    /// The same of an image's terms, or of a part of its bricks.
    void apply(const DepthTerms& terms) { apply(terms, terms.bricks); }
    void apply(const DepthTerms& terms, std::span<const BrickTerms> bricks);

    [[nodiscard]] Occupancy occupancy(VoxelKey key) const noexcept;
    /// Empty for unknown.
    [[nodiscard]] std::optional<float> log_odds(VoxelKey key) const noexcept;
    [[nodiscard]] Occupancy occupancy_of(float log_odds) const noexcept;

    [[nodiscard]] const MapConfig& config() const noexcept;
    [[nodiscard]] const VoxelLattice& lattice() const noexcept;
    [[nodiscard]] double resolution_m() const noexcept;
    [[nodiscard]] const MapCounters& counters() const noexcept;

    /// The voxel that holds a point of the map frame; empty for a point that is not finite or outside the
    /// octree.
    [[nodiscard]] std::optional<VoxelKey> key_of(const Eigen::Vector3d& p_map) const noexcept;
    [[nodiscard]] Eigen::Vector3d centre_of(VoxelKey key) const noexcept;

    [[nodiscard]] std::size_t known_voxels() const noexcept;
    /// What the map's space may come to take of the heap, of `MapConfig::memory_max_mib`.
    [[nodiscard]] std::size_t memory_bytes() const noexcept;
    /// What it takes now. Space whose voxels are alike takes next to nothing.
    [[nodiscard]] std::size_t heap_bytes() const noexcept { return tree_.memory_bytes(); }
    /// Visits every known voxel once, in Morton order (an octree's depth-first order), whatever the order in
    /// which the map was filled. O(voxels).
    void for_each_known(const std::function<void(VoxelKey, float log_odds)>& visit) const;

    /// All of the space that the map takes, in Morton order. O(bricks).
    [[nodiscard]] std::vector<MapBrick> bricks() const;

    /// Gives every voxel of a cube this value, clamped; for building a map from a file. False if there was no
    /// room (then part of the cube may be set) or the value is not finite.
    [[nodiscard]] bool set_cube(const VoxelCube& cube, float log_odds);

  private:
    FusedMap(const FusedMap&) noexcept = default;

    /// Which counter tells that a term was refused.
    using Refusal = std::uint64_t MapCounters::*;

    [[nodiscard]] bool has_room_for(MortonCode brick) const noexcept;
    /// Makes `write` write a brick, unless there is no room or no memory for it.
    template <class Write>
    [[nodiscard]] Status<Refusal> change(MortonCode brick, Write&& write) noexcept;
    [[nodiscard]] ClampedTerm clamped(float log_odds) const noexcept {
        return {log_odds, config_.log_odds_min, config_.log_odds_max};
    }
    void add(float& voxel, float log_odds) noexcept;
    [[nodiscard]] std::size_t apply_some(std::span<const VoxelUpdate> updates) noexcept;
    void apply_run(BrickValues* values, std::span<const VoxelUpdate> run) noexcept;
    void apply_brick(const DepthTerms& terms, const BrickTerms& brick) noexcept;

    MapConfig config_;
    VoxelLattice lattice_;
    MapCounters counters_;
    BrickTree tree_;
    std::size_t known_voxels_ = 0;
};

}  // namespace octoskin
