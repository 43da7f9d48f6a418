// Compiled once for each instruction set that Highway knows; the best one is chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/core/bricks/brick_stamps.cpp"
// clang-format off: foreach_target.h comes before highway.h
#include "host/core/bricks/brick_stamps.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on

#include <cassert>

HWY_BEFORE_NAMESPACE();
namespace octoskin::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Eight lanes at most: a mask in memory is then one byte for every instruction set, except for those with
// vectors of less than 128 bits, where a byte contains more than one vector.
using StampTag = hn::CappedTag<std::uint16_t, 8>;
constexpr std::size_t kWordVoxels = 64;

/// Calls use(index of the first voxel, mask of the lanes in the set) for each vector until it returns false.
template <class Use>
void for_each_vector(const std::uint64_t* words, const Use& use) {
    const StampTag s;
    for (std::size_t word = 0; word < kBrickVoxels / kWordVoxels; ++word) {
        if (words[word] == 0) continue;
        for (std::size_t first = 0; first < kWordVoxels; first += hn::Lanes(s)) {
            const std::uint8_t bits[8] = {static_cast<std::uint8_t>(words[word] >> first)};
            if (!use(word * kWordVoxels + first, hn::LoadMaskBits(s, bits))) return;
        }
    }
}

void put_stamp(std::uint16_t* stamps, const std::uint64_t* words, std::uint16_t stamp) {
    const StampTag s;
    const auto value = hn::Set(s, stamp);
    for_each_vector(words, [&](std::size_t first, const auto& is_meant) {
        hn::StoreU(hn::IfThenElse(is_meant, value, hn::LoadU(s, stamps + first)), s, stamps + first);
        return true;
    });
}

bool has_other_stamp(const std::uint16_t* stamps, const std::uint64_t* words, std::uint16_t stamp) {
    const StampTag s;
    const auto value = hn::Set(s, stamp);
    bool has_other = false;
    for_each_vector(words, [&](std::size_t first, const auto& is_meant) {
        const auto is_other = hn::Ne(hn::LoadU(s, stamps + first), value);
        has_other = !hn::AllFalse(s, hn::And(is_other, is_meant));
        return !has_other;
    });
    return has_other;
}

std::uint64_t stamps_below(const std::uint16_t* stamps, std::uint16_t limit) {
    const StampTag s;
    const auto value = hn::Set(s, limit);
    std::uint64_t below = 0;
    for (std::size_t first = 0; first < kWordVoxels; first += hn::Lanes(s)) {
        std::uint8_t bits[8] = {};
        hn::StoreMaskBits(s, hn::Lt(hn::LoadU(s, stamps + first), value), bits);
        below |= std::uint64_t{bits[0]} << first;
    }
    return below;
}

}  // namespace octoskin::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace octoskin {
namespace {

HWY_EXPORT(put_stamp);
HWY_EXPORT(has_other_stamp);
HWY_EXPORT(stamps_below);

}  // namespace

void put_stamp(BrickStamps& stamps, const BrickMask& voxels, std::uint16_t stamp) noexcept {
    HWY_DYNAMIC_DISPATCH(put_stamp)(stamps.data(), voxels.data(), stamp);
}

bool has_other_stamp(const BrickStamps& stamps, const BrickMask& voxels, std::uint16_t stamp) noexcept {
    return HWY_DYNAMIC_DISPATCH(has_other_stamp)(stamps.data(), voxels.data(), stamp);
}

std::uint64_t stamps_below(const BrickStamps& stamps, std::size_t word, std::uint16_t limit) noexcept {
    assert(word < kBrickVoxels / 64);
    return HWY_DYNAMIC_DISPATCH(stamps_below)(stamps.data() + 64 * word, limit);
}

}  // namespace octoskin
#endif
