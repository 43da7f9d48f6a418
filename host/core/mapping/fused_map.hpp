// The map: occupied, free and unknown space in log-odds, in the map frame, with OctoMap's keys and
// arithmetic. The only type of the mapping room that others hold. Files and octomap::OcTree: host/io/mapfile.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <new>
#include <optional>
#include <span>
#include <vector>

#include "common/result.hpp"
#include "common/time.hpp"
#include "host/core/bricks/brick_terms.hpp"
#include "host/core/bricks/brick_tree.hpp"
#include "host/core/mapping/cone_voxels.hpp"
#include "host/core/mapping/confirmations.hpp"
#include "host/core/mapping/depth_terms.hpp"
#include "host/core/mapping/map_config.hpp"
#include "host/core/mapping/range_counts.hpp"
#include "host/core/voxels/key_box.hpp"
#include "host/core/voxels/morton.hpp"
#include "host/core/voxels/voxel_lattice.hpp"

namespace octoskin {

enum class Occupancy : std::uint8_t { unknown, free, occupied };

/// What became of every update ever given to a map: in = the sum of these.
struct MapCounters {
    std::uint64_t applied = 0;
    std::uint64_t zero = 0;        ///< a term of 0 touches nothing
    std::uint64_t not_finite = 0;  ///< refused
    std::uint64_t no_room = 0;     ///< refused: the voxel's space is new, and `memory_max_mib` is reached
    std::uint64_t no_memory = 0;   ///< refused: the voxel's space is new, and the system has no memory for it
    /// Applied like others, but there was no room or memory for their time. Not of the sum.
    std::uint64_t undated = 0;
    [[nodiscard]] std::uint64_t refused() const noexcept { return no_room + no_memory; }
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
    /// Visits, in Morton order, each brick in which this map may differ from `before`, an earlier copy of it;
    /// of a map that has nothing in common with it, each brick of both. O(what was written since).
    void for_each_difference(const FusedMap& before,
                             const std::function<void(const MapBrick& now)>& visit) const;

    /// From now on other limits hold, at the same resolution (asserted): what lies beyond new clamps is
    /// clamped; bricks beyond a smaller memory stay. The counters begin anew. O(voxels) if the clamps change.
    /// Throws std::bad_alloc if there is no memory for as many voxels once more, if the clamps or the counts'
    /// model change; then nothing is changed.
    void limit(const MapConfig& config);

    /// What was counted becomes log-odds like any other, and counting begins anew: what a file keeps of a
    /// map. Where times come to decide what is known (`age.unknown_after_s`), they are forgotten, too, and
    /// the clock begins anew. O(what was counted).
    void forget_counts() noexcept;

    /// What range sensors counted in these voxels is forgotten; a term for each of them is to follow. Throws
    /// std::bad_alloc.
    void forget_counts_of(std::span<const VoxelUpdate> voxels);

    /// Time goes on, to when what is applied next was measured. A map that was never told the time keeps
    /// none of its voxels'; told it first, nobody knows how old what it holds is, and that is stale until it
    /// is confirmed. What nobody has confirmed for `age.unknown_after_s` is forgotten, at the next whole
    /// second. Confirmed is what a term changes or would change but for a clamp, what a cone passes, and what
    /// is not free in its cap (counts in unknown voxels are forgotten in the same way). No more than O(1)
    /// within a second; in a new one, if voxels are ever forgotten, a 64th of the bricks are looked at and
    /// those that may have voxels that are too old: some 50 us for 10,000 bricks, and all of them the first
    /// time.
    void go_on(HostTime now) noexcept;
    /// The time that is told from now on is ahead by this of the one that was told before (or behind, below
    /// 0): a clock was set, nothing has become older.
    void leap(Nanoseconds by) noexcept { confirmations_.leap(by); }

    /// Adds each term to its voxel (unknown counts as 0 before) and clamps, one by one, in order, in
    /// OctoMap's single precision. A term of 0 touches nothing: in OctoMap a node at log-odds 0 counts as
    /// occupied. A term that is not finite is refused and counted, as is one for space that cannot be had:
    /// the next one is tried again. Never throws. About 5 ns an update if neighbours come together. `kind`:
    /// of the sensor that the terms are of.
    void apply(std::span<const VoxelUpdate> updates, SensorKind kind = SensorKind::range);
    /// Counts a cone's range: each voxel of its cap gets its share of `model.hit_mass` hits, in proportion to
    /// weight and probability before, so that what is known to be there takes the blame, or only those that
    /// are occupied do, if `blame` says so; each that was passed `model.miss_mass` misses. Refused and
    /// counted as above, voxel by voxel. `changes`, if not null, is told by how much the log-odds changed.
    /// Never throws but for `changes`. About 25 ns a voxel.
    void apply(const ConeVoxels& cone, const ConeModel& model, Blame blame = Blame::all,
               std::vector<VoxelUpdate>* changes = nullptr);
    /// Of a range that is believed (StandingRanges), after it was counted: if no voxel of its cap is
    /// occupied, which would explain it, those of its middle are from now on. They have no misses, and at
    /// least so many hits, and as many as that takes. Refused, counted and told as above.
    void mark(const ConeVoxels& cone, float hits, std::vector<VoxelUpdate>* changes = nullptr);
    /// Of a range that is believed no longer: what its cap has of hits that mark nothing is gone. From one
    /// place they tell nothing of where in the cap it was, and with each thing that comes and goes there they
    /// would grow. Refused and told as above.
    void forget_weak_hits(const ConeVoxels& cone, std::vector<VoxelUpdate>* changes = nullptr);
    /// Of a sensor that surely sees through (StandingSight), after it was counted: what was passed and is
    /// occupied is free from now on, has no hits and nothing that the camera once knew of it; but for what
    /// the camera confirmed in this second or the one before, and what `is_ranged` says of: others see it.
    /// Refused, counted and told as above.
    void clear(const ConeVoxels& cone, const std::function<bool(VoxelKey)>& is_ranged,
               std::vector<VoxelUpdate>* changes = nullptr);
    /// As with VoxelUpdates, of an image's terms, or of a part of its bricks. Where there are counts, the
    /// terms go to what the log-odds are without them.
    void apply(const DepthTerms& terms) { apply(terms, terms.bricks); }
    void apply(const DepthTerms& terms, std::span<const BrickTerms> bricks);

    [[nodiscard]] Occupancy occupancy(VoxelKey key) const noexcept;
    /// Empty for unknown.
    [[nodiscard]] std::optional<float> log_odds(VoxelKey key) const noexcept;
    [[nodiscard]] Occupancy occupancy_of(float log_odds) const noexcept;
    /// When and by what a known voxel was last confirmed; empty for an unknown one and where nobody knows.
    [[nodiscard]] std::optional<Confirmation> confirmation(VoxelKey key) const noexcept;
    /// A known voxel that nobody has confirmed for `age.stale_after_s`, or of which nobody knows. None is if
    /// the map was never told the time.
    [[nodiscard]] bool is_stale(VoxelKey key) const noexcept;
    /// Known voxels with a stamp below this one are stale; 0 if none can be.
    [[nodiscard]] std::uint16_t stale_stamp() const noexcept;

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
    /// What it takes now, counts and times included. Space whose voxels are alike takes next to nothing.
    [[nodiscard]] std::size_t heap_bytes() const noexcept {
        return tree_.memory_bytes() + counts_.heap_bytes() + confirmations_.heap_bytes();
    }
    [[nodiscard]] const Confirmations& confirmations() const noexcept { return confirmations_; }
    [[nodiscard]] const RangeCounts& counts() const noexcept { return counts_; }
    /// Visits every known voxel once, in Morton order (an octree's depth-first order), whatever the order in
    /// which the map was filled. O(voxels).
    void for_each_known(const std::function<void(VoxelKey, float log_odds)>& visit) const;

    /// All of the space that the map takes, in Morton order. O(bricks).
    [[nodiscard]] std::vector<MapBrick> bricks() const;

    /// The brick whose first voxel this is, for as long as it is unchanged; it need not be known.
    [[nodiscard]] BrickView brick(MortonCode first) const noexcept { return tree_.find(first); }

    /// All of the octree, to be followed from large cubes to small ones; for as long as the map is unchanged.
    [[nodiscard]] BrickTree::Space space() const noexcept { return tree_.space(); }

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
    [[nodiscard]] Status<Refusal> change(MortonCode brick, Write&& write) noexcept {
        if (tree_.find(brick).is_unknown() && !has_room_for(brick)) return unexpected(&MapCounters::no_room);
        try {
            write();
            return Done{};
        } catch (const std::bad_alloc&) {
            return unexpected(&MapCounters::no_memory);
        }
    }
    [[nodiscard]] ClampedTerm clamped(float log_odds) const noexcept {
        return {log_odds, config_.log_odds_min, config_.log_odds_max};
    }
    /// Of an image all of whose rays pass a voxel.
    [[nodiscard]] ClampedTerm passed_term(float miss) const noexcept {
        ClampedTerm term = clamped(miss);
        if (miss < 0.0F) term.max = std::max(term.min, std::min(term.max, config_.log_odds_passed_max));
        return term;
    }
    /// Of an image of which rays end in it, whatever they come to.
    [[nodiscard]] ClampedTerm hit_term(float log_odds) const noexcept {
        ClampedTerm term = clamped(log_odds);
        if (log_odds > 0.0F) term.min = std::min(term.max, std::max(term.min, config_.log_odds_hit_min));
        return term;
    }
    void add(float& voxel, const ClampedTerm& term) noexcept;
    [[nodiscard]] std::size_t apply_owned(std::span<const VoxelUpdate> updates) noexcept;
    void apply_run(std::span<const VoxelUpdate> run) noexcept;
    void apply_brick(const DepthTerms& terms, const BrickTerms& brick) noexcept;

    class CountedBrick;
    [[nodiscard]] bool has_room_to_count(MortonCode brick) const noexcept;
    void apply_beside_counts(std::span<const VoxelUpdate> run) noexcept;
    void apply_beside_counts(const DepthTerms& terms, const BrickTerms& brick) noexcept;
    /// In this second or the one before.
    [[nodiscard]] bool is_seen_by_camera(std::uint16_t stamp) const noexcept;
    void take(VoxelKey key, const Result<float, Refusal>& change, std::vector<VoxelUpdate>* changes);
    /// Makes every voxel of a brick with counts what they and its other log-odds say.
    void fuse(MortonCode brick);
    void set_known(float& voxel, float log_odds) noexcept;

    void date_all();
    [[nodiscard]] bool has_room_to_date(MortonCode brick) const noexcept;
    void confirm(MortonCode brick, const BrickMask& voxels, SensorKind kind) noexcept;
    void confirm(std::span<const VoxelUpdate> updates, SensorKind kind) noexcept;
    void confirm(const DepthTerms& terms, const BrickTerms& brick) noexcept;
    void confirm(const ConeVoxels& cone) noexcept;
    /// Throws std::bad_alloc.
    void expire();
    void forget_log_odds(MortonCode brick, const BrickMask& voxels);

    MapConfig config_;
    VoxelLattice lattice_;
    MapCounters counters_;
    BrickTree tree_;
    RangeCounts counts_;
    CountFusion fusion_;
    Confirmations confirmations_;
    bool has_undated_ = false;  ///< what was there when the clock began has not all been dated
    std::size_t known_voxels_ = 0;
};

}  // namespace octoskin
