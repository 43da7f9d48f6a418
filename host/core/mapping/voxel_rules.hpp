// What a measurement makes of one voxel: the definition of the map. BrickEditor does the same to many voxels
// at once, and a property test holds it to these rules bit by bit.
#pragma once

#include <cmath>
#include <cstdint>

#include "host/core/bricks/brick.hpp"
#include "host/core/bricks/brick_terms.hpp"
#include "host/core/mapping/map_config.hpp"

namespace octoskin {

enum class Occupancy : std::uint8_t { unknown, free, occupied };

/// All that a map holds of a voxel, but for when it was last seen (VoxelAges).
struct VoxelState {
    float log_odds = kUnknownLogOdds;  ///< what the map answers; a NaN: unknown
    float prior = kUnknownLogOdds;     ///< of all measurements that are not counted; a NaN: none
    float hits = 0.0F;                 ///< what range sensors that see a cone have counted
    float misses = 0.0F;
};

/// The rules, one voxel at a time. Each leaves `log_odds` what the rest comes to: without counts the prior;
/// with counts ln((a + hits) / (b + misses)), a and b from CountModel and the prior, moved so that
/// `occupied_probability` comes to `log_odds_occupied`, and clamped; below `log_odds_occupied` if hits are
/// fewer than `hits_min` and the prior is. A voxel that is unknown stays so until that is enough to say it.
class VoxelRules {
  public:
    /// Clamps finite, log_odds_min <= 0 <= log_odds_max; the counts' priors positive, their probability
    /// between 0 and 1 (asserted).
    explicit VoxelRules(const MapConfig& config);

    /// A term in log-odds, finite and not 0, of any sensor but a camera.
    void add(VoxelState& voxel, float term) const noexcept;
    /// An image all of whose rays pass the voxel.
    void miss(VoxelState& voxel, float term) const noexcept;
    /// An image of which rays end in the voxel, whatever they come to.
    void hit(VoxelState& voxel, float term) const noexcept;
    /// A range's share of hits, or its misses.
    void count(VoxelState& voxel, float hits, float misses) const noexcept;
    /// Occupied from now on, with at least so many hits and no misses.
    void confirm(VoxelState& voxel, float hits) const noexcept;
    /// The hits are gone. From one place they tell nothing of where in its cap a range ended, and with each
    /// thing that comes and goes there they would grow.
    void withdraw(VoxelState& voxel) const noexcept;
    /// Free from now on, without hits and without what a camera once knew of it.
    void clear(VoxelState& voxel) const noexcept;
    /// As if nothing had ever been measured there.
    static void expire(VoxelState& voxel) noexcept { voxel = {}; }
    /// Makes `log_odds` what the rest comes to, under other limits.
    void fuse(VoxelState& voxel) const noexcept;

    /// Whether a range that passes a voxel dates it: not what is occupied and a camera saw just now. While
    /// the camera looks, its evidence is the newest, and what passes there contradicts it.
    template <class IsSeen>
    [[nodiscard]] bool dates_passed(float log_odds, const IsSeen& is_seen_by_camera) const {
        return !is_occupied(log_odds) || !is_seen_by_camera();
    }
    /// Whether a range that may end in a voxel dates it: not what is free, which a hit that is shared does
    /// not confirm. What is unknown and was given hits has its time, so that counts that lead to nothing
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
    /// False for a NaN.
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
    /// Hits that mark a voxel without misses, and hardly more.
    [[nodiscard]] float hits_that_mark(float prior) const noexcept;
    /// Misses that free a known voxel without hits, and hardly more.
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
    float shift_;  ///< of log-odds
    /// Odds beyond which the clamps hold. A logarithm costs as much as all else.
    float odds_min_;
    float odds_max_;
    float odds_occupied_;
};

}  // namespace octoskin
