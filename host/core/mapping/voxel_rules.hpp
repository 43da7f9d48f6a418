// Effect of a measurement on one voxel: the definition of the map. BrickEditor and the writers do the same
// for many voxels at once, and a property test compares them with these rules bit by bit.
#pragma once

#include <cmath>
#include <cstdint>

#include "host/core/bricks/brick.hpp"
#include "host/core/bricks/brick_terms.hpp"
#include "host/core/mapping/map_config.hpp"

namespace octoskin {

enum class Occupancy : std::uint8_t { unknown, free, occupied };

/// Everything that a map stores about a voxel, except when it was last seen (VoxelAges).
struct VoxelState {
    float log_odds = kUnknownLogOdds;  ///< the voxel's value for queries; NaN: unknown
    float prior = kUnknownLogOdds;     ///< from all measurements that are not counted; NaN: none
    float hits = 0.0F;                 ///< counts of range sensors that see a cone
    float misses = 0.0F;
};

/// The rules for one voxel. Each rule updates `log_odds` from the other members. Without counts, it is the
/// prior. With counts, it is ln((a + hits) / (b + misses)), with a and b from CountModel and the prior,
/// shifted so that `occupied_probability` becomes `log_odds_occupied`, and clamped. It is below
/// `log_odds_occupied` if there are fewer hits than `hits_min` and the prior is below. An unknown voxel stays
/// unknown until the counts are sufficient.
class VoxelRules {
  public:
    /// Requires: clamps finite, log_odds_min <= 0 <= log_odds_max; the counts' priors positive, their
    /// probability between 0 and 1 (asserted).
    explicit VoxelRules(const MapConfig& config);

    /// Adds a term in log-odds, finite and not 0, of any sensor except a camera.
    void add(VoxelState& voxel, float term) const noexcept;
    /// Takes an image whose rays all pass the voxel.
    void miss(VoxelState& voxel, float term) const noexcept;
    /// Takes an image with rays that end in the voxel, whatever the sum of their terms.
    void hit(VoxelState& voxel, float term) const noexcept;
    /// Adds a range's share of hits, or its misses.
    void count(VoxelState& voxel, float hits, float misses) const noexcept;
    /// Makes the voxel occupied, with at least `hits` hits and no misses.
    void confirm(VoxelState& voxel, float hits) const noexcept;
    /// Removes the hits. Hits from one place do not show where in its cap a range ended. Without this rule,
    /// they would accumulate with each object that appears and leaves there.
    void withdraw(VoxelState& voxel) const noexcept;
    /// Makes the voxel free, without hits and without the camera's earlier evidence that it is occupied.
    void clear(VoxelState& voxel) const noexcept;
    /// Adds a term below 0 to the evidence, other than counts, that the voxel is occupied. When that no
    /// longer marks the voxel, all of it is removed: without counts that suffice to know the voxel, it
    /// becomes unknown, never free.
    void weaken(VoxelState& voxel, float term) const noexcept;
    /// Makes the voxel unknown, as if nothing had ever been measured there.
    static void expire(VoxelState& voxel) noexcept { voxel = {}; }
    /// Recomputes `log_odds` from the other members, for instance under other limits.
    void fuse(VoxelState& voxel) const noexcept;

    /// True if a range that passes a voxel gives it a time stamp. False for an occupied voxel that a camera
    /// has just seen: the camera's evidence is newer, and the passing range contradicts it.
    template <class IsSeen>
    [[nodiscard]] bool dates_passed(float log_odds, const IsSeen& is_seen_by_camera) const {
        return !is_occupied(log_odds) || !is_seen_by_camera();
    }
    /// True if a range that may end in a voxel gives it a time stamp. False for a free voxel, which a shared
    /// hit does not confirm. An unknown voxel that gets hits has a time stamp, so that counts without effect
    /// expire.
    template <class IsSeen>
    [[nodiscard]] bool dates_in_cap(float log_odds, float weight, const IsSeen& is_seen_by_camera) const {
        return std::isnan(log_odds) ? weight > 0.0F : is_occupied(log_odds) && !is_seen_by_camera();
    }

    /// Expected share of hits, (a + hits) / (a + b + hits + misses).
    [[nodiscard]] float probability(const VoxelState& voxel) const noexcept {
        const float for_it = hits_known(voxel.prior) + voxel.hits;
        return for_it / (for_it + misses_known(voxel.prior) + voxel.misses);
    }
    /// False for NaN.
    [[nodiscard]] bool is_occupied(float log_odds) const noexcept { return log_odds >= occupied_; }
    [[nodiscard]] Occupancy occupancy(float log_odds) const noexcept {
        if (std::isnan(log_odds)) return Occupancy::unknown;
        return is_occupied(log_odds) ? Occupancy::occupied : Occupancy::free;
    }
    [[nodiscard]] float clamped(float log_odds) const noexcept;
    [[nodiscard]] const CountModel& counts() const noexcept { return model_; }

    /// `add`, `miss` and `hit` as one addition to a prior, for many voxels at once.
    [[nodiscard]] ClampedTerm added(float term) const noexcept { return {term, min_, max_}; }
    [[nodiscard]] ClampedTerm missed(float term) const noexcept;
    [[nodiscard]] ClampedTerm hit_by(float term) const noexcept;

  private:
    [[nodiscard]] float log_odds_of(const VoxelState& voxel, bool is_known) const noexcept;
    [[nodiscard]] float log_odds_of(float odds) const noexcept;
    [[nodiscard]] float hits_known(float prior) const noexcept {
        return model_.prior_hits + (prior > 0.0F ? hits_per_log_odds_ * prior : 0.0F);
    }
    [[nodiscard]] float misses_known(float prior) const noexcept {
        return model_.prior_misses + (prior < 0.0F ? misses_per_log_odds_ * prior : 0.0F);
    }
    /// Slightly more than the fewest hits that make a voxel without misses occupied.
    [[nodiscard]] float hits_that_mark(float prior) const noexcept;
    /// Slightly more than the fewest misses that make a known voxel without hits free.
    [[nodiscard]] float misses_that_free(float prior) const noexcept;

    CountModel model_;
    float min_;
    float max_;
    float passed_max_;
    float hit_min_;
    float occupied_;
    float below_occupied_;
    float hits_per_log_odds_;
    float misses_per_log_odds_;
    float shift_;  ///< shift of log-odds
    /// Odds beyond which the clamps apply. Comparing them avoids the logarithm, half of the total cost.
    float odds_min_;
    float odds_max_;
    float odds_occupied_;
};

}  // namespace octoskin
