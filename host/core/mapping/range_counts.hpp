// What range sensors that see a cone have counted, voxel by voxel, beside the log-odds of everything else.
#pragma once

#include <cmath>
#include <cstddef>

#include "host/core/bricks/brick_tree.hpp"
#include "host/core/mapping/cone_model.hpp"

namespace octoskin {

/// What range sensors counted of one voxel.
struct HitsAndMisses {
    float hits = 0.0F;
    float misses = 0.0F;

    /// Both are scaled down to `counts_max` together.
    void add(float more_hits, float more_misses, float counts_max) noexcept {
        hits += more_hits;
        misses += more_misses;
        const float sum = hits + misses;
        if (sum > counts_max) {
            hits *= counts_max / sum;
            misses *= counts_max / sum;
        }
    }
};

/// What a voxel's counts and its log-odds without them come to together.
class CountFusion {
  public:
    /// `model`'s priors are positive, its probability is between 0 and 1 (asserted).
    CountFusion(const CountModel& model, float log_odds_min, float log_odds_max, float log_odds_occupied);

    /// Expected share of hits, (a + hits) / (a + b + hits + misses). `other`: a NaN for unknown.
    [[nodiscard]] float probability(float other, const HitsAndMisses& counts) const noexcept {
        const float for_it = hits_known(other) + counts.hits;
        return for_it / (for_it + misses_known(other) + counts.misses);
    }
    /// ln((a + hits) / (b + misses)), moved so that `occupied_probability` comes to `log_odds_occupied`, and
    /// clamped; below `log_odds_occupied` if hits are fewer than `hits_min` and `other` is; a NaN (unknown)
    /// if there is too little to say so and the voxel is not `is_known` already. Without counts `other`
    /// itself.
    [[nodiscard]] float log_odds(float other, const HitsAndMisses& counts, bool is_known) const noexcept;

    /// Hits that mark a voxel without misses, and hardly more.
    [[nodiscard]] float hits_that_mark(float other) const noexcept;
    /// Misses that free a known voxel without hits of which nothing else is known but what speaks against it,
    /// and hardly more.
    [[nodiscard]] float misses_that_free(float other) const noexcept;

  private:
    [[nodiscard]] float hits_known(float other) const noexcept {
        return model_.prior_hits + (other > 0.0F ? hits_per_log_odds_ * other : 0.0F);
    }
    [[nodiscard]] float misses_known(float other) const noexcept {
        return model_.prior_misses + (other < 0.0F ? misses_per_log_odds_ * other : 0.0F);
    }
    [[nodiscard]] float log_odds_of(float odds) const noexcept;

    CountModel model_;
    float min_;
    float max_;
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

/// Bricks in which something was counted. Copies share what they have in common, as a BrickTree's do.
struct RangeCounts {
    BrickTree other;   ///< log-odds of everything else there; unknown where nothing else was
    BrickTree misses;  ///< of the same bricks as `hits`
    BrickTree hits;

    [[nodiscard]] bool empty() const noexcept { return hits.bricks() == 0; }
    [[nodiscard]] bool has(MortonCode brick) const noexcept { return !hits.find(brick).is_unknown(); }
    /// Begins to count in a brick whose log-odds are `now`. Throws std::bad_alloc; then it has not begun.
    void begin(MortonCode brick, const BrickView& now);
    /// Makes it so that in some voxels of a brick nothing was counted or known. Throws std::bad_alloc.
    void forget(MortonCode brick, const BrickMask& voxels);
    /// If every brick had a value of its own for each voxel.
    [[nodiscard]] std::size_t bytes_at_most() const noexcept;
    /// What a further brick may take.
    [[nodiscard]] std::size_t bytes_of_new(MortonCode brick) const noexcept;
    [[nodiscard]] std::size_t heap_bytes() const noexcept;
};

}  // namespace octoskin
