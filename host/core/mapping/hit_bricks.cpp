// Compiled once for each instruction set that Highway knows; the best one is chosen at run time.
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

#include "host/core/traversal/lanes-inl.hpp"

#ifndef OCTOSKIN_HIT_BRICKS_TYPES
#define OCTOSKIN_HIT_BRICKS_TYPES
namespace octoskin {

/// A row of PlacedImage, from its first pixel on.
struct RowOfEnds {
    const std::uint32_t* key_xy;
    const std::uint32_t* key_z;
    const double* range_m;  ///< null: there are distances
    const float* distance_m;
};

BrickMask HitBricks::mask_of(MortonCode brick) const noexcept {
    BrickMask mask{};
    for (const CellHits& hit : of(brick)) mask[hit.cell / 64] |= std::uint64_t{1} << (hit.cell % 64);
    return mask;
}

}  // namespace octoskin
#endif

HWY_BEFORE_NAMESPACE();
namespace octoskin::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// HitModel::log_odds() of each pixel, in the ranges' own precision.
template <class T>
HWY_INLINE void find_terms(const T* ranges_m, const HitModel& model, std::size_t width, float* terms) {
    const hn::CappedTag<T, 64 / sizeof(T)> t;
    const hn::Rebind<float, decltype(t)> f;
    const auto range_min = hn::Set(t, static_cast<T>(model.range_min_m));
    const auto offset = hn::Set(t, static_cast<T>(model.offset));
    const auto slope_per_m = hn::Set(t, static_cast<T>(model.slope_per_m));
    for (std::size_t u = 0; u < width; u += hn::Lanes(t)) {
        const auto range = hn::LoadU(t, ranges_m + u);
        const auto is_below = model.is_min_exclusive ? hn::Le(range, range_min) : hn::Lt(range, range_min);
        const auto term = hn::IfThenZeroElse(is_below, hn::Sub(offset, hn::Mul(slope_per_m, range)));
        if constexpr (sizeof(T) == sizeof(float)) {
            hn::StoreU(term, t, terms + u);
        } else {
            hn::StoreU(hn::DemoteTo(f, term), f, terms + u);
        }
    }
}

/// The terms of a row, and a bit for each pixel whose next one ends elsewhere; both for whole words of 64
/// pixels, of which those beyond the row mean nothing.
void find_runs(const RowOfEnds& row, const HitModel& model, std::size_t width, float* terms,
               std::uint64_t* run_ends) {
    const hn::CappedTag<std::uint32_t, 16> k;
    for (std::size_t word = 0; 64 * word < width; ++word) {
        run_ends[word] = 0;
        for (std::size_t bit = 0; bit < 64 && 64 * word + bit < width; bit += hn::Lanes(k)) {
            const std::size_t u = 64 * word + bit;
            const auto differs = [&](const std::uint32_t* keys) HWY_ATTR {
                return hn::Ne(hn::LoadU(k, keys + u), hn::LoadU(k, keys + u + 1));
            };
            run_ends[word] |= bits_of(k, hn::Or(differs(row.key_xy), differs(row.key_z))) << bit;
        }
    }
    if (row.range_m != nullptr) {
        find_terms(row.range_m, model, width, terms);
    } else {
        find_terms(row.distance_m, model, width, terms);
    }
}

}  // namespace octoskin::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace octoskin {
namespace {

HWY_EXPORT(find_runs);

}  // namespace

bool HitBricks::take(const PlacedImage& rays, const KeyBox& box, const HitModel& model,
                     std::size_t voxels_max) {
    if (!begin(box, voxels_max)) return false;
    for (std::size_t band = 0; band < kBands; ++band) find(rays, model, band);
    sort();
    return true;
}

bool HitBricks::begin(const KeyBox& box, std::size_t voxels_max) {
    const auto bricks_along = [](std::uint16_t low, std::uint16_t high) {
        return static_cast<std::size_t>((high >> kBrickHeight) - (low >> kBrickHeight)) + 1;
    };
    const std::size_t bricks_x = bricks_along(box.lowest.x, box.highest.x);
    const std::size_t bricks_y = bricks_along(box.lowest.y, box.highest.y);
    const std::size_t bricks = bricks_x * bricks_y * bricks_along(box.lowest.z, box.highest.z);
    if (bricks * kBrickVoxels > voxels_max) return false;
    box_ = box;
    bricks_x_ = bricks_x;
    bricks_y_ = bricks_y;
    ends_.assign(bricks, 0);
    return true;
}

void HitBricks::find(const PlacedImage& rays, const HitModel& model, std::size_t band) {
    Band& own = bands_.at(band);
    own.count = 0;
    const auto row_at = [&](std::size_t part) {
        return static_cast<std::uint32_t>(std::size_t{rays.height} * part / kBands);
    };
    const std::size_t rows = row_at(band + 1) - row_at(band);
    own.runs.resize(std::max(own.runs.size(), rows * rays.width));
    own.bricks.resize(own.runs.size());
    for (std::uint32_t v = row_at(band); v < row_at(band + 1); ++v)
        take_row(rays, std::size_t{v} * rays.width, model, own);
}

void HitBricks::sort() {
    std::size_t found = 0;
    for (const Band& band : bands_) {
        for (std::size_t i = 0; i < band.count; ++i) ++ends_[band.bricks[i]];
        found += band.count;
    }
    std::uint32_t begin = 0;
    for (std::uint32_t& end : ends_) {
        const std::uint32_t count = end;
        end = begin;  // for now where it begins
        begin += count;
    }
    if (sorted_.size() < found) sorted_.resize(found);
    for (const Band& band : bands_) {
        for (std::size_t i = 0; i < band.count; ++i) sorted_[ends_[band.bricks[i]]++] = band.runs[i];
    }
}

void HitBricks::take_row(const PlacedImage& rays, std::size_t first, const HitModel& model,
                         Band& band) const {
    constexpr std::size_t kWordBits = 64;
    assert(rays.width <= std::numeric_limits<std::uint16_t>::max());  // of CellHits::rays; a rig has 4096
    std::vector<std::uint64_t>& run_ends = band.run_ends;
    run_ends.resize((rays.width + kWordBits - 1) / kWordBits);
    band.terms.resize(run_ends.size() * kWordBits);
    const std::uint32_t* const key_xy = rays.key_xy.data() + first;
    const std::uint32_t* const key_z = rays.key_z.data() + first;
    HWY_DYNAMIC_DISPATCH(find_runs)
    ({key_xy, key_z, rays.range_m.empty() ? nullptr : rays.range_m.data() + first,
      rays.range_m.empty() ? rays.distance_m.data() + first : nullptr},
     model, rays.width, band.terms.data(), run_ends.data());
    run_ends.back() &= ~std::uint64_t{0} >> (kWordBits * run_ends.size() - rays.width);
    run_ends.back() |= std::uint64_t{1} << ((rays.width - 1) % kWordBits);

    std::size_t begin = 0;
    for (std::size_t word = 0; word < run_ends.size(); ++word) {
        for (std::uint64_t bits = run_ends[word]; bits != 0; bits &= bits - 1) {
            const std::size_t last = kWordBits * word + static_cast<std::size_t>(std::countr_zero(bits));
            if (key_z[last] != PlacedImage::kNoKey) {
                const VoxelKey key{static_cast<std::uint16_t>(key_xy[last]),
                                   static_cast<std::uint16_t>(key_xy[last] >> 16U),
                                   static_cast<std::uint16_t>(key_z[last])};
                band.runs[band.count] = run_of(key, std::span(band.terms).subspan(begin, last + 1 - begin));
                band.bricks[band.count] = static_cast<std::uint32_t>(index_of(key));
                ++band.count;
            }
            begin = last + 1;
        }
    }
}

CellHits HitBricks::run_of(VoxelKey key, std::span<const float> terms) {
    CellHits hits{.cell = static_cast<std::uint16_t>(cell_of(key)),
                  .rays = static_cast<std::uint16_t>(terms.size()),
                  .sum = terms.front(),
                  .most = terms.front()};
    for (const float term : terms.subspan(1)) {
        hits.sum += term;
        hits.most = term > hits.most ? term : hits.most;
    }
    return hits;
}

std::span<const CellHits> HitBricks::of(MortonCode brick) const noexcept {
    const VoxelKey lowest = key_of_morton(brick);
    if (!do_meet({lowest, kBrickHeight}, box_)) return {};
    const std::size_t at = index_of(lowest);
    const std::size_t begin = at == 0 ? 0 : ends_[at - 1];
    return std::span(sorted_).subspan(begin, ends_[at] - begin);
}

}  // namespace octoskin
#endif
