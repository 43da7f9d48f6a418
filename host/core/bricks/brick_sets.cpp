// Compiled once for each instruction set that Highway knows; the best one is chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/core/bricks/brick_sets.cpp"
// clang-format off: foreach_target.h comes before highway.h
#include "host/core/bricks/brick_sets.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on

#include <cassert>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace octoskin::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Sixteen lanes at most: the number of bytes of a mask is then known for every instruction set.
using Tag = hn::CappedTag<float, 16>;

template <class Mask>
std::uint64_t bits_of(Tag f, const Mask& mask) {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(f, mask, bytes);
    return static_cast<std::uint64_t>(bytes[0]) | (static_cast<std::uint64_t>(bytes[1]) << 8U);
}

WordSets sets_of(const float* values, float at_least) {
    const Tag f;
    const auto limit = hn::Set(f, at_least);
    WordSets sets;
    for (std::size_t first = 0; first < 64; first += hn::Lanes(f)) {
        const auto value = hn::LoadU(f, values + first);
        sets.known |= bits_of(f, hn::Eq(value, value)) << first;
        sets.at_least |= bits_of(f, hn::Ge(value, limit)) << first;
    }
    return sets;
}

}  // namespace octoskin::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace octoskin {
namespace {

HWY_EXPORT(sets_of);

}  // namespace

WordSets sets_of(const BrickValues& values, std::size_t word, float at_least) noexcept {
    assert(word < kBrickVoxels / 64);
    return HWY_DYNAMIC_DISPATCH(sets_of)(values.data() + 64 * word, at_least);
}

}  // namespace octoskin
#endif
