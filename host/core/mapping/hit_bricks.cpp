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

#include "host/core/bricks/brick_sets.hpp"
#include "host/core/traversal/lanes-inl.hpp"

#ifndef OCTOSKIN_HIT_BRICKS_TYPES
#define OCTOSKIN_HIT_BRICKS_TYPES
namespace octoskin {

/// A row of ProjectedImage, from its first pixel on.
struct RowOfEnds {
    const std::uint32_t* key_xy;
    const std::uint32_t* key_z;
    const double* range_m;
};

BrickMask HitBricks::mask_of(MortonCode brick) const noexcept {
    BrickMask mask{};
    for (const CellHits& hit : of(brick)) put_in(mask, hit.cell);
    return mask;
}

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

/// The terms of a row, and a bit for each pixel whose right neighbour ends in another voxel. Both fill whole
/// words of 64 pixels; those beyond the row are undefined.
void find_row_runs(const RowOfEnds& row, const HitModel& model, std::size_t width, float* terms,
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
    find_terms(row.range_m, model, width, terms);
}

}  // namespace octoskin::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace octoskin {
namespace {

HWY_EXPORT(find_row_runs);

}  // namespace

bool HitBricks::take(const ProjectedImage& rays, const KeyBox& box, const HitModel& model,
                     std::size_t voxels_max) {
    const BrickBox bricks = BrickBox::of(box);
    if (bricks.bricks() * kBrickVoxels > voxels_max) return false;
    box_ = bricks;
    ends_.assign(bricks.bricks(), 0);
    runs_.resize(std::max(runs_.size(), rays.pixels()));
    bricks_.resize(runs_.size());
    count_ = 0;
    for (std::uint32_t v = 0; v < rays.height; ++v) take_row(rays, std::size_t{v} * rays.width, model);
    sort();
    return true;
}

void HitBricks::take_row(const ProjectedImage& rays, std::size_t first, const HitModel& model) {
    constexpr std::size_t kWordBits = 64;
    run_ends_.resize((rays.width + kWordBits - 1) / kWordBits);
    terms_.resize(run_ends_.size() * kWordBits);
    const std::uint32_t* const key_xy = rays.key_xy.data() + first;
    const std::uint32_t* const key_z = rays.key_z.data() + first;
    HWY_DYNAMIC_DISPATCH(find_row_runs)
    ({key_xy, key_z, rays.range_m.data() + first}, model, rays.width, terms_.data(), run_ends_.data());
    run_ends_.back() &= ~std::uint64_t{0} >> (kWordBits * run_ends_.size() - rays.width);
    run_ends_.back() |= std::uint64_t{1} << ((rays.width - 1) % kWordBits);

    std::size_t begin = 0;
    for (std::size_t word = 0; word < run_ends_.size(); ++word) {
        for (std::uint64_t bits = run_ends_[word]; bits != 0; bits &= bits - 1) {
            const std::size_t last = kWordBits * word + static_cast<std::size_t>(std::countr_zero(bits));
            if (key_z[last] != ProjectedImage::kNoKey) {
                const VoxelKey key{static_cast<std::uint16_t>(key_xy[last]),
                                   static_cast<std::uint16_t>(key_xy[last] >> 16U),
                                   static_cast<std::uint16_t>(key_z[last])};
                const auto run = std::span(terms_).subspan(begin, last + 1 - begin);
                runs_[count_] = {static_cast<std::uint16_t>(cell_of(key)), std::ranges::max(run)};
                bricks_[count_] = static_cast<std::uint32_t>(box_.index(BrickPlace::of(key)));
                ++count_;
            }
            begin = last + 1;
        }
    }
}

void HitBricks::sort() {
    for (std::size_t i = 0; i < count_; ++i) ++ends_[bricks_[i]];
    std::uint32_t begin = 0;
    for (std::uint32_t& end : ends_) {
        const std::uint32_t count = end;
        end = begin;  // temporarily its begin
        begin += count;
    }
    if (sorted_.size() < count_) sorted_.resize(count_);
    for (std::size_t i = 0; i < count_; ++i) sorted_[ends_[bricks_[i]]++] = runs_[i];
}

std::span<const CellHits> HitBricks::of(MortonCode brick) const noexcept {
    const BrickPlace place = BrickPlace::of(key_of_morton(brick));
    if (!box_.holds(place)) return {};
    const std::size_t at = box_.index(place);
    const std::size_t begin = at == 0 ? 0 : ends_[at - 1];
    return std::span(sorted_).subspan(begin, ends_[at] - begin);
}

}  // namespace octoskin
#endif
