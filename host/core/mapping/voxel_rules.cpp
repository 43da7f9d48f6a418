#include "host/core/mapping/voxel_rules.hpp"

#include <algorithm>
#include <cassert>
#include <limits>

namespace octoskin {
namespace {

/// Keeps a voxel on its side of the threshold despite rounding.
constexpr float kForRounding = 1.001F;
/// Smaller counts become 0, so that repeated images clear a count completely.
constexpr float kLeastCount = 0.01F;

/// Odds of a probability; their logarithm gives log-odds.
float odds_of(float probability) {
    return probability / (1.0F - probability);
}

/// What remains of a count that an image contradicts.
float after_image(float count, float share) {
    const float left = count * (1.0F - share);
    return left < kLeastCount ? 0.0F : left;
}

}  // namespace

VoxelRules::VoxelRules(const MapConfig& config)
    : model_(config.counts),
      min_(config.log_odds_min),
      max_(config.log_odds_max),
      passed_max_(config.log_odds_passed_max),
      hit_min_(config.log_odds_hit_min),
      occupied_(config.log_odds_occupied),
      below_occupied_(
          std::max(min_, std::nextafter(config.log_odds_occupied, -std::numeric_limits<float>::max()))),
      hits_per_log_odds_(max_ > 0.0F ? model_.occupied_hits / max_ : 0.0F),
      misses_per_log_odds_(min_ < 0.0F ? model_.free_misses / min_ : 0.0F),
      shift_(occupied_ - std::log(odds_of(model_.occupied_probability))),
      odds_min_(std::exp(min_ - shift_)),
      odds_max_(std::exp(max_ - shift_)),
      odds_occupied_(odds_of(model_.occupied_probability)) {
    assert(std::isfinite(min_) && std::isfinite(max_));
    assert(min_ <= 0.0F && max_ >= 0.0F);
    assert(model_.prior_hits > 0.0F && model_.prior_misses > 0.0F);
    assert(model_.occupied_probability > 0.0F && model_.occupied_probability < 1.0F);
}

float VoxelRules::clamped(float log_odds) const noexcept {
    return std::clamp(log_odds, min_, max_);
}

ClampedTerm VoxelRules::missed(float term) const noexcept {
    ClampedTerm clamps = added(term);
    if (term < 0.0F) clamps.max = std::max(clamps.min, std::min(clamps.max, passed_max_));
    return clamps;
}

ClampedTerm VoxelRules::hit_by(float term) const noexcept {
    ClampedTerm clamps = added(term);
    if (term > 0.0F) clamps.min = std::min(clamps.max, std::max(clamps.min, hit_min_));
    return clamps;
}

void VoxelRules::add(VoxelState& voxel, float term) const noexcept {
    voxel.prior = added(term).added_to(voxel.prior);
    voxel.log_odds = log_odds_of(voxel, true);
}

void VoxelRules::miss(VoxelState& voxel, float term) const noexcept {
    voxel.prior = missed(term).added_to(voxel.prior);
    if (model_.image_clears > 0.0F) voxel.hits = after_image(voxel.hits, model_.image_clears);
    voxel.log_odds = log_odds_of(voxel, true);
}

void VoxelRules::hit(VoxelState& voxel, float term) const noexcept {
    voxel.prior = hit_by(term).added_to(voxel.prior);
    if (model_.image_marks > 0.0F && term > 0.0F)
        voxel.misses = after_image(voxel.misses, model_.image_marks);
    voxel.log_odds = log_odds_of(voxel, true);
}

void VoxelRules::count(VoxelState& voxel, float hits, float misses) const noexcept {
    voxel.hits += hits;
    voxel.misses += misses;
    const float sum = voxel.hits + voxel.misses;
    if (sum > model_.counts_max) {
        voxel.hits *= model_.counts_max / sum;
        voxel.misses *= model_.counts_max / sum;
    }
    const bool clears_prior =
        model_.range_clears > 0.0F && misses > 0.0F && voxel.misses >= model_.range_clears_from;
    if (clears_prior && voxel.prior > 0.0F) voxel.prior = std::max(voxel.prior - model_.range_clears, min_);
    fuse(voxel);
}

void VoxelRules::confirm(VoxelState& voxel, float hits) const noexcept {
    voxel.hits = std::max(voxel.hits, std::max(hits, hits_that_mark(voxel.prior)));
    voxel.misses = 0.0F;
    fuse(voxel);
}

void VoxelRules::withdraw(VoxelState& voxel) const noexcept {
    voxel.hits = 0.0F;
    fuse(voxel);
}

void VoxelRules::clear(VoxelState& voxel) const noexcept {
    if (voxel.prior > 0.0F) voxel.prior = kUnknownLogOdds;
    voxel.hits = 0.0F;
    voxel.misses = std::max(voxel.misses, misses_that_free(voxel.prior));
    fuse(voxel);
}

void VoxelRules::weaken(VoxelState& voxel, float term) const noexcept {
    if (!is_occupied(voxel.prior)) return;
    const float weaker = clamped(voxel.prior + term);
    const bool is_left = is_occupied(weaker);
    voxel.prior = is_left ? weaker : kUnknownLogOdds;
    voxel.log_odds = log_odds_of(voxel, is_left);
}

void VoxelRules::fuse(VoxelState& voxel) const noexcept {
    const float log_odds = log_odds_of(voxel, !std::isnan(voxel.log_odds));
    if (!std::isnan(log_odds)) voxel.log_odds = log_odds;
}

float VoxelRules::log_odds_of(float odds) const noexcept {
    if (odds <= odds_min_) return min_;
    if (odds >= odds_max_) return max_;
    return std::clamp(std::log(odds) + shift_, min_, max_);
}

float VoxelRules::log_odds_of(const VoxelState& voxel, bool is_known) const noexcept {
    if (voxel.hits == 0.0F && voxel.misses == 0.0F) return voxel.prior;
    const float odds = (hits_known(voxel.prior) + voxel.hits) / (misses_known(voxel.prior) + voxel.misses);
    const bool is_marked =
        odds >= odds_occupied_ && (voxel.hits >= model_.hits_min || voxel.prior >= occupied_);
    if (is_marked) return std::max(log_odds_of(odds), occupied_);
    const bool is_free = is_known || !std::isnan(voxel.prior) || voxel.misses > model_.misses_min;
    return is_free ? std::min(log_odds_of(odds), below_occupied_) : kUnknownLogOdds;
}

float VoxelRules::hits_that_mark(float prior) const noexcept {
    const float hits = odds_occupied_ * misses_known(prior) - hits_known(prior);
    return kForRounding * std::max(hits, model_.hits_min);
}

float VoxelRules::misses_that_free(float prior) const noexcept {
    constexpr float kLeast = 0.01F;  // without misses, the voxel would be unknown
    const float misses = hits_known(prior) / odds_occupied_ - misses_known(prior);
    return std::max(kForRounding * misses, kLeast);
}

}  // namespace octoskin
