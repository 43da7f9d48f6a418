// Compiled once for each instruction set that Highway knows; the best one is chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/core/bricks/brick_terms.cpp"
// clang-format off: foreach_target.h comes before highway.h
#include "host/core/bricks/brick_terms.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on

#include <bit>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace octoskin::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Sixteen lanes at most: the size of a mask in memory is then known for every instruction set.
using Tag = hn::CappedTag<float, 16>;

std::size_t add_to_voxels(float* values, const std::uint64_t* words, const ClampedTerm& term) {
    const Tag f;
    constexpr std::size_t kWordBits = 64;
    const std::size_t lanes = hn::Lanes(f);
    const auto log_odds = hn::Set(f, term.log_odds);
    const auto min = hn::Set(f, term.min);
    const auto max = hn::Set(f, term.max);
    std::size_t unknown = 0;
    for (std::size_t word = 0; word < kBrickVoxels / kWordBits; ++word) {
        if (words[word] == 0) continue;
        for (std::size_t first = 0; first < kWordBits; first += lanes) {
            const auto bits = static_cast<std::uint16_t>(words[word] >> first);
            const std::uint8_t bytes[8] = {static_cast<std::uint8_t>(bits & 0xFFU),
                                           static_cast<std::uint8_t>(bits >> 8U)};
            const auto is_meant = hn::LoadMaskBits(f, bytes);
            float* const at = values + word * kWordBits + first;
            const auto before = hn::LoadU(f, at);
            const auto is_known = hn::Eq(before, before);
            const auto sum = hn::Add(hn::IfThenElseZero(is_known, before), log_odds);
            const auto after = hn::Min(hn::Max(sum, min), max);
            unknown += hn::CountTrue(f, hn::AndNot(is_known, is_meant));
            hn::StoreU(hn::IfThenElse(is_meant, after, before), f, at);
        }
    }
    return unknown;
}

/// One voxel at a time, because a voxel may occur twice.
std::size_t add_to_each(float* const* voxels, const CellTerm* cells, std::size_t count,
                        const ClampedTerm& clamps) {
    const hn::CappedTag<float, 1> f;
    const auto min = hn::Set(f, clamps.min);
    const auto max = hn::Set(f, clamps.max);
    auto known = hn::Zero(f);
    for (std::size_t i = 0; i < count; ++i) {
        const auto before = hn::Load(f, voxels[i]);
        const auto is_known = hn::Eq(before, before);
        const auto sum = hn::Add(hn::IfThenElseZero(is_known, before), hn::Set(f, cells[i].term));
        hn::Store(hn::Min(max, hn::Max(min, sum)), f, voxels[i]);
        known = hn::Add(known, hn::IfThenElseZero(is_known, hn::Set(f, 1.0F)));
    }
    return count - static_cast<std::size_t>(hn::GetLane(known));
}

bool are_alike(const float* values) {
    const Tag f;
    const auto first = hn::Set(f, values[0]);
    for (std::size_t i = 0; i < kBrickVoxels; i += hn::Lanes(f)) {
        if (!hn::AllTrue(f, hn::Eq(hn::LoadU(f, values + i), first))) return false;
    }
    return true;
}

}  // namespace octoskin::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace octoskin {
namespace {

HWY_EXPORT(add_to_voxels);
HWY_EXPORT(add_to_each);
HWY_EXPORT(are_alike);

}  // namespace

std::size_t add_to_voxels(BrickValues& values, const BrickMask& voxels, const ClampedTerm& term) noexcept {
    return HWY_DYNAMIC_DISPATCH(add_to_voxels)(values.data(), voxels.data(), term);
}

std::size_t add_to_each(std::span<float* const> voxels, std::span<const CellTerm> cells,
                        const ClampedTerm& clamps) noexcept {
    return HWY_DYNAMIC_DISPATCH(add_to_each)(voxels.data(), cells.data(), voxels.size(), clamps);
}

bool are_alike(const BrickValues& values) noexcept {
    return values.front() == values.back() && HWY_DYNAMIC_DISPATCH(are_alike)(values.data());
}

}  // namespace octoskin
#endif
