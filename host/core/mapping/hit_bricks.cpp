// Compiled once for each instruction set that Highway supports; the best one is chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/core/mapping/hit_bricks.cpp"
// clang-format off: foreach_target.h comes before highway.h
#include "host/core/mapping/hit_bricks.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on

#include <algorithm>
#include <bit>
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

/// The ends of a row, by axis, and how much further or less far they may be.
struct RowOfDoubts {
    std::array<const float*, kAxisCount> end;
    const float* reach_m;
    const float* doubt_m;  ///< along the optical axis
    std::array<float, kAxisCount> origin;
    float voxels_per_m;
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

/// The face of its voxel that each end may be beyond, numbered as in HitBricks::FaceMasks, or `certain`.
/// Reads and writes whole vectors.
void find_faces(const RowOfDoubts& row, std::uint32_t certain, std::uint32_t* faces) {
    const hn::ScalableTag<float> f;
    const hn::RebindToUnsigned<decltype(f)> k;
    const auto voxels_per_m = hn::Set(f, row.voxels_per_m);
    for (std::size_t u = 0; u < row.width; u += hn::Lanes(f)) {
        const auto reach = hn::LoadU(f, row.reach_m + u);
        // How far the end may move in units of its reach: each coordinate from the camera grows with it.
        auto least = hn::Div(hn::LoadU(f, row.doubt_m + u), reach);
        auto found = hn::Set(k, certain);
        for (std::size_t axis = 0; axis < kAxisCount; ++axis) {
            const auto end = hn::LoadU(f, row.end[axis] + u);
            const auto scaled = hn::Mul(end, voxels_per_m);
            const auto above_face = hn::Sub(scaled, hn::Round(scaled));
            const auto from_camera =
                hn::Abs(hn::Mul(hn::Sub(end, hn::Set(f, row.origin[axis])), voxels_per_m));
            // Compared without a division: the ray may be parallel to the face.
            const auto to_face = hn::Abs(above_face);
            const auto is_nearer = hn::Lt(to_face, hn::Mul(least, from_camera));
            least = hn::IfThenElse(is_nearer, hn::Div(to_face, from_camera), least);
            const auto face = hn::Set(k, static_cast<std::uint32_t>(2 * axis));
            const auto is_below_face = hn::RebindMask(k, hn::Lt(above_face, hn::Zero(f)));
            found = hn::IfThenElse(hn::RebindMask(k, is_nearer),
                                   hn::IfThenElse(is_below_face, hn::Add(face, hn::Set(k, 1)), face), found);
        }
        hn::StoreU(found, k, faces + u);
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

HWY_EXPORT(find_faces);
HWY_EXPORT(find_row_hits);
HWY_EXPORT(hits_of);

constexpr std::size_t kWordBits = 64;
/// The places in a word whose bit `bit` is set.
constexpr std::array<std::uint64_t, 6> kWithBit = {0xAAAA'AAAA'AAAA'AAAA, 0xCCCC'CCCC'CCCC'CCCC,
                                                   0xF0F0'F0F0'F0F0'F0F0, 0xFF00'FF00'FF00'FF00,
                                                   0xFFFF'0000'FFFF'0000, 0xFFFF'FFFF'0000'0000};

/// The voxels of a word whose neighbour above along `axis` is in `word`, or in `next`, the word above.
constexpr std::uint64_t below(std::uint64_t word, std::uint64_t next, std::size_t axis) {
    const std::uint64_t is_odd = kWithBit[axis];
    const std::uint64_t is_high = kWithBit[3 + axis];
    return (word >> (1U << axis) & ~is_odd) | (word >> (7U << axis) & is_odd & ~is_high) |
           (next << (9U << axis) & is_odd & is_high);
}
/// The same below.
constexpr std::uint64_t above(std::uint64_t word, std::uint64_t before, std::size_t axis) {
    const std::uint64_t is_odd = kWithBit[axis];
    const std::uint64_t is_high = kWithBit[3 + axis];
    return (word << (1U << axis) & is_odd) | (word << (7U << axis) & ~is_odd & is_high) |
           (before >> (9U << axis) & ~is_odd & ~is_high);
}

}  // namespace

bool HitBricks::take(const ProjectedImage& rays, const EndDoubts& doubts, const KeyBox& box,
                     const HitModel& model, std::size_t voxels_max) {
    assert(doubts.depths_m.empty() || doubts.depths_m.size() >= rays.pixels() + kLanesMax);
    const BrickBox bricks = BrickBox::of(box);
    if (bricks.bricks() * kBrickVoxels > voxels_max) return false;
    box_ = bricks;
    clear(kBrickWords * bricks.bricks() + 1);
    places_.resize(rays.width + kLanesMax);
    bits_.resize(places_.size());
    row_terms_.resize(places_.size());
    faces_.assign(places_.size(), kCertain);
    for (std::uint32_t v = 0; v < rays.height; ++v)
        take_row(rays, doubts, std::size_t{v} * rays.width, model);
    if (!doubts.depths_m.empty()) settle_doubts();
    return true;
}

/// Only the words that the previous image used are not zero.
void HitBricks::clear(std::size_t words) {
    for (const std::uint32_t word : used_) words_[word] = 0;
    used_.clear();
    if (words_.size() < words) words_.resize(words, 0);
    terms_.assign(kWordBits, kNoHit);
    masks_.assign(1, {});
}

void HitBricks::take_row(const ProjectedImage& rays, const EndDoubts& doubts, std::size_t first,
                         const HitModel& model) {
    const WordGrid grid = word_grid_of(box_);
    HWY_DYNAMIC_DISPATCH(find_row_hits)
    (grid, {rays.key_xy.data() + first, rays.key_z.data() + first, rays.range_m.data() + first, rays.width},
     model, {places_.data(), bits_.data(), row_terms_.data()});
    if (!doubts.depths_m.empty()) {
        HWY_DYNAMIC_DISPATCH(find_faces)
        ({.end = {rays.end_x.data() + first, rays.end_y.data() + first, rays.end_z.data() + first},
          .reach_m = rays.reach_m.data() + first,
          .doubt_m = doubts.depths_m.data() + first,
          .origin = {rays.origin.x(), rays.origin.y(), rays.origin.z()},
          .voxels_per_m = static_cast<float>(1.0 / doubts.resolution_m),
          .width = rays.width},
         kCertain, faces_.data());
    }
    for (std::size_t u = 0; u < rays.width; ++u) {
        const std::uint32_t place = places_[u];
        if (words_[place] != 0 || place == grid.nowhere) continue;
        words_[place] = static_cast<std::uint32_t>(terms_.size());
        used_.push_back(place);
        terms_.resize(terms_.size() + kWordBits, kNoHit);
        masks_.push_back({});
    }
    const auto put = [&, terms = terms_.data(), masks = masks_.data(), words = words_.data()](std::size_t u) {
        const std::uint32_t word = words[places_[u]];
        masks[word / kWordBits][faces_[u]] |= std::uint64_t{1} << bits_[u];
        float& most = terms[word + bits_[u]];
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

void HitBricks::settle_doubts() {
    masks_.front() = {};  // of no voxel
    for (const std::uint32_t place : used_) {
        const std::uint32_t word = words_[place];
        const FaceMasks& masks = masks_[word / kWordBits];
        std::uint64_t stay = masks[kCertain];
        std::uint64_t uncertain = 0;
        for (std::size_t face = 0; face < kCertain; ++face) {
            if ((masks[face] & ~stay) == 0) continue;
            uncertain |= masks[face];
            stay |= masks[face] & ~beside_certain(place, face);
        }
        for (std::uint64_t rest = uncertain & ~stay; rest != 0; rest &= rest - 1)
            terms_[word + static_cast<std::size_t>(std::countr_zero(rest))] = 0.0F;
    }
}

/// The voxels of a word of the grid whose neighbour beyond `face` is certainly hit.
std::uint64_t HitBricks::beside_certain(std::uint32_t place, std::size_t face) const {
    const std::size_t axis = face / 2;
    const bool is_above = face % 2 != 0;
    const std::size_t bit = std::size_t{1} << axis;
    const auto steps = static_cast<std::ptrdiff_t>(word_grid_of(box_).steps[axis]);
    const std::size_t brick = place / kBrickWords;
    const std::size_t across = static_cast<std::size_t>(steps) / kBrickWords;
    const std::size_t along = brick / across % box_.edge(axis);
    const bool is_high = (place & bit) != 0;
    const bool is_last = is_above ? is_high && along + 1 == box_.edge(axis) : !is_high && along == 0;
    const auto to_other = static_cast<std::ptrdiff_t>(bit) * (is_high ? -1 : 1);
    const std::ptrdiff_t to_next = is_above == is_high ? to_other + (is_above ? steps : -steps) : to_other;
    const std::uint64_t own = certain_in(place);
    const std::uint64_t next = is_last ? 0 : certain_in(static_cast<std::ptrdiff_t>(place) + to_next);
    return is_above ? below(own, next, axis) : above(own, next, axis);
}

std::uint64_t HitBricks::certain_in(std::ptrdiff_t place) const {
    return masks_[words_[static_cast<std::size_t>(place)] / kWordBits][kCertain];
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
