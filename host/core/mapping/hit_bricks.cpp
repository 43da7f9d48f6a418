// Compiled once for each instruction set that Highway supports; the best one is chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/core/mapping/hit_bricks.cpp"
// clang-format off: foreach_target.h comes before highway.h
#include "host/core/mapping/hit_bricks.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on

#include <algorithm>
#include <cassert>
#include <limits>
#include <span>

#include "host/core/traversal/end_places-inl.hpp"
#include "host/core/traversal/image_bands.hpp"
#include "host/core/traversal/lanes-inl.hpp"

#ifndef OCTOSKIN_HIT_BRICKS_TYPES
#define OCTOSKIN_HIT_BRICKS_TYPES
namespace octoskin {

/// A row of ProjectedImage, from its first pixel on.
struct RowOfEnds {
    const std::uint32_t* key_xy;
    const std::uint32_t* key_z;
    const double* range_m;
    std::size_t width;
};

/// Where the word and the voxel of each ray of a row are stored, and its term.
struct RowHits {
    std::uint32_t* places;
    std::uint32_t* bits;
    float* terms;
};

/// Less than any term.
inline constexpr float kNoHit = -std::numeric_limits<float>::infinity();

}  // namespace octoskin
#endif

HWY_BEFORE_NAMESPACE();
namespace octoskin::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// HitModel::log_odds() of each pixel.
HWY_INLINE void find_terms(const double* ranges_m, const HitModel& model, std::size_t width, float* terms) {
    const Doubles d;
    const auto range_min = hn::Set(d, model.range_min_m);
    const auto offset = hn::Set(d, model.offset);
    const auto slope_per_m = hn::Set(d, model.slope_per_m);
    for (std::size_t u = 0; u < width; u += hn::Lanes(d)) {
        const auto range = hn::LoadU(d, ranges_m + u);
        const auto is_below = model.is_min_exclusive ? hn::Le(range, range_min) : hn::Lt(range, range_min);
        const auto term = hn::IfThenZeroElse(is_below, hn::Sub(offset, hn::Mul(slope_per_m, range)));
        hn::StoreU(hn::DemoteTo(Floats(), term), Floats(), terms + u);
    }
}

/// Reads and writes whole vectors.
void find_row_hits(const WordGrid& grid, const RowOfEnds& row, const HitModel& model, const RowHits& hits) {
    find_places(grid, row.key_xy, row.key_z, row.width, hits.places, hits.bits);
    find_terms(row.range_m, model, row.width, hits.terms);
}

/// The voxels of a word with hits, from its 64 terms.
std::uint64_t hits_of(const float* terms) {
    const hn::CappedTag<float, 16> f;
    std::uint64_t hits = 0;
    for (std::size_t bit = 0; bit < 64; bit += hn::Lanes(f))
        hits |= bits_of(f, hn::Ne(hn::LoadU(f, terms + bit), hn::Set(f, kNoHit))) << bit;
    return hits;
}

}  // namespace octoskin::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace octoskin {
namespace {

HWY_EXPORT(find_row_hits);
HWY_EXPORT(hits_of);

constexpr std::size_t kWordBits = 64;

}  // namespace

bool HitBricks::take(const ProjectedImage& rays, const KeyBox& box, const HitModel& model,
                     std::size_t voxels_max) {
    const BrickBox bricks = BrickBox::of(box);
    if (bricks.bricks() * kBrickVoxels > voxels_max) return false;
    box_ = bricks;
    clear(kBrickWords * bricks.bricks() + 1);
    places_.resize(rays.width + kLanesMax);
    bits_.resize(places_.size());
    row_terms_.resize(places_.size());
    for (std::uint32_t v = 0; v < rays.height; ++v) take_row(rays, std::size_t{v} * rays.width, model);
    return true;
}

/// Only the words that the previous image used are not zero.
void HitBricks::clear(std::size_t words) {
    for (const std::uint32_t word : used_) words_[word] = 0;
    used_.clear();
    if (words_.size() < words) words_.resize(words, 0);
    terms_.assign(kWordBits, kNoHit);
}

void HitBricks::take_row(const ProjectedImage& rays, std::size_t first, const HitModel& model) {
    const WordGrid grid = word_grid_of(box_);
    HWY_DYNAMIC_DISPATCH(find_row_hits)
    (grid, {rays.key_xy.data() + first, rays.key_z.data() + first, rays.range_m.data() + first, rays.width},
     model, {places_.data(), bits_.data(), row_terms_.data()});
    for (std::size_t u = 0; u < rays.width; ++u) {
        const std::uint32_t place = places_[u];
        if (words_[place] != 0 || place == grid.nowhere) continue;
        words_[place] = static_cast<std::uint32_t>(terms_.size());
        used_.push_back(place);
        terms_.resize(terms_.size() + kWordBits, kNoHit);
    }
    const auto put = [&, terms = terms_.data(), words = words_.data()](std::size_t u) {
        float& most = terms[words[places_[u]] + bits_[u]];
        const float term = row_terms_[u];
        most = term > most ? term : most;
    };
    // Neighbouring pixels often share a voxel, and each write would wait for the one before.
    const std::size_t quarter = rays.width / 4;
    for (std::size_t u = 0; u < quarter; ++u) {
        put(u);
        put(u + quarter);
        put(u + 2 * quarter);
        put(u + 3 * quarter);
    }
    for (std::size_t u = 4 * quarter; u < rays.width; ++u) put(u);
}

BrickHits HitBricks::of(MortonCode brick) const noexcept {
    BrickHits hits;
    const BrickPlace place = BrickPlace::of(key_of_morton(brick));
    if (!box_.holds(place)) return hits;
    const std::uint32_t* const words = words_.data() + kBrickWords * box_.index(place);
    for (std::size_t word = 0; word < kBrickWords; ++word) {
        if (words[word] == 0) continue;
        hits.words_[word] = terms_.data() + words[word];
        hits.mask_[word] = HWY_DYNAMIC_DISPATCH(hits_of)(hits.words_[word]);
    }
    return hits;
}

}  // namespace octoskin
#endif
