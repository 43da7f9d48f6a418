// Vectors of the instruction set that is being compiled for; included once for each (see Highway's
// foreach_target.h, which comes before).
#if defined(OCTOSKIN_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef OCTOSKIN_LANES_INL
#undef OCTOSKIN_LANES_INL
#else
#define OCTOSKIN_LANES_INL
#endif

#include <hwy/highway.h>

#include <array>
#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace octoskin::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// As many doubles as a vector holds, and as many floats and integers.
using Doubles = hn::ScalableTag<double>;
using Floats = hn::Rebind<float, Doubles>;
using Ints = hn::Rebind<std::int32_t, Doubles>;
using Double = hn::Vec<Doubles>;
using Float = hn::Vec<Floats>;
using Mask = hn::Mask<Doubles>;

/// Bit i is that of lane i. Sixteen lanes at most: they fit two bytes.
template <class Tag, class AnyMask>
HWY_INLINE std::uint64_t bits_of(Tag tag, AnyMask mask) {
    std::array<std::uint8_t, 8> bits{};
    hn::StoreMaskBits(tag, mask, bits.data());
    return (bits[0] | static_cast<std::uint64_t>(bits[1]) << 8U) &
           ((std::uint64_t{1} << hn::Lanes(tag)) - 1U);
}

/// Calls visit(lane) for each lane that is set, in ascending order.
template <class Tag, class AnyMask, class Visit>
HWY_INLINE void for_each_set(Tag tag, AnyMask mask, Visit&& visit) {
    std::array<std::uint8_t, hn::MaxLanes(Tag()) / 8 + 8> bits{};
    hn::StoreMaskBits(tag, mask, bits.data());
    for (std::size_t lane = 0; lane < hn::Lanes(tag); ++lane) {
        if ((bits[lane / 8] >> (lane % 8) & 1U) != 0) visit(lane);
    }
}

/// The length of (x, y, z) as OctoMap computes it: in single precision but for the square root.
HWY_INLINE Double length_of(Float x, Float y, Float z) {
    const Float squared = hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z));
    return hn::Sqrt(hn::PromoteTo(Doubles(), squared));
}

}  // namespace octoskin::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
