#include "host/core/mapping/range_counts.hpp"

#include <algorithm>
#include <cassert>
#include <limits>

#include "host/core/bricks/brick_sets.hpp"

namespace octoskin {

CountFusion::CountFusion(const CountModel& model, float log_odds_min, float log_odds_max,
                         float log_odds_occupied)
    : model_(model),
      min_(log_odds_min),
      max_(log_odds_max),
      occupied_(log_odds_occupied),
      below_occupied_(
          std::max(log_odds_min, std::nextafter(log_odds_occupied, -std::numeric_limits<float>::max()))),
      hits_per_log_odds_(log_odds_max > 0.0F ? model.occupied_hits / log_odds_max : 0.0F),
      misses_per_log_odds_(log_odds_min < 0.0F ? model.free_misses / log_odds_min : 0.0F),
      shift_(log_odds_occupied - std::log(model.occupied_probability / (1.0F - model.occupied_probability))),
      odds_min_(std::exp(log_odds_min - shift_)),
      odds_max_(std::exp(log_odds_max - shift_)),
      odds_occupied_(model.occupied_probability / (1.0F - model.occupied_probability)) {
    assert(model.prior_hits > 0.0F && model.prior_misses > 0.0F);
    assert(model.occupied_probability > 0.0F && model.occupied_probability < 1.0F);
}

float CountFusion::log_odds_of(float odds) const noexcept {
    if (odds <= odds_min_) return min_;
    if (odds >= odds_max_) return max_;
    return std::clamp(std::log(odds) + shift_, min_, max_);
}

float CountFusion::log_odds(float other, const HitsAndMisses& counts, bool is_known) const noexcept {
    if (counts.hits == 0.0F && counts.misses == 0.0F) return other;
    const float odds = (hits_known(other) + counts.hits) / (misses_known(other) + counts.misses);
    const bool is_marked = odds >= odds_occupied_ && (counts.hits >= model_.hits_min || other >= occupied_);
    // Rounding must not lead to the other side of the threshold.
    if (is_marked) return std::max(log_odds_of(odds), occupied_);
    const bool is_free = is_known || other == other || counts.misses > model_.misses_min;
    return is_free ? std::min(log_odds_of(odds), below_occupied_) : kUnknownLogOdds;
}

float CountFusion::hits_that_mark(float other) const noexcept {
    constexpr float kForRounding = 1.001F;
    const float hits = odds_occupied_ * misses_known(other) - hits_known(other);
    return kForRounding * std::max(hits, model_.hits_min);
}

float CountFusion::misses_that_free(float other) const noexcept {
    constexpr float kForRounding = 1.001F;
    constexpr float kLeast = 0.01F;  // with none, nothing would be known of it
    const float misses = hits_known(other) / odds_occupied_ - misses_known(other);
    return std::max(kForRounding * misses, kLeast);
}

void RangeCounts::begin(MortonCode brick, const BrickView& now) {
    misses.set_all(brick, 0.0F);
    if (now.values != nullptr) {
        other.open(brick) = *now.values;
    } else if (!now.is_unknown()) {
        other.set_all(brick, now.value);
    }
    hits.set_all(brick, 0.0F);
}

void RangeCounts::forget(MortonCode brick, const BrickMask& voxels) {
    const auto put = [&](BrickTree& tree, float value) {
        if (tree.find(brick).is_unknown()) return;
        BrickValues& values = tree.open(brick);
        for_each_cell(voxels, [&](std::size_t cell) { values[cell] = value; });
    };
    if (std::ranges::all_of(voxels, [](std::uint64_t word) { return word == ~std::uint64_t{0}; })) {
        for (BrickTree* tree : {&hits, &misses, &other}) tree->forget(brick);
        return;
    }
    put(other, kUnknownLogOdds);
    put(misses, 0.0F);
    put(hits, 0.0F);
    const auto is_none = [&](std::size_t cell) {
        return hits.find(brick).at(cell) == 0.0F && misses.find(brick).at(cell) == 0.0F &&
               std::isnan(other.find(brick).at(cell));
    };
    for (std::size_t cell = 0; cell < kBrickVoxels; ++cell)
        if (!is_none(cell)) return;
    for (BrickTree* tree : {&hits, &misses, &other}) tree->forget(brick);
}

std::size_t RangeCounts::bytes_at_most() const noexcept {
    const auto bytes = [](const BrickTree& tree) {
        return tree.nodes() * BrickTree::kNodeBytes + tree.bricks() * BrickTree::kBrickBytes;
    };
    // What has no other log-odds yet may come to have some.
    return bytes(hits) + bytes(misses) + std::max(bytes(other), bytes(hits));
}

std::size_t RangeCounts::bytes_of_new(MortonCode brick) const noexcept {
    return 3 * (hits.nodes_missing(brick) * BrickTree::kNodeBytes + BrickTree::kBrickBytes);
}

std::size_t RangeCounts::heap_bytes() const noexcept {
    return hits.memory_bytes() + misses.memory_bytes() + other.memory_bytes();
}

}  // namespace octoskin
