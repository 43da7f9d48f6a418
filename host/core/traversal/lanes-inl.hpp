// Vector types of the instruction set being compiled. Included once for each (see Highway's foreach_target.h,
// which comes before).
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

/// Vectors of doubles, and of as many floats and integers.
using Doubles = hn::ScalableTag<double>;
using Floats = hn::Rebind<float, Doubles>;
using Ints = hn::Rebind<std::int32_t, Doubles>;
using Double = hn::Vec<Doubles>;
using Float = hn::Vec<Floats>;
using Mask = hn::Mask<Doubles>;

/// Bit i is lane i. Sixteen lanes at most, which fit two bytes.
template <class Tag, class AnyMask>
HWY_INLINE std::uint64_t bits_of(Tag tag, AnyMask mask) {
    std::array<std::uint8_t, 8> bits{};
    hn::StoreMaskBits(tag, mask, bits.data());
    return (bits[0] | static_cast<std::uint64_t>(bits[1]) << 8U) &
           ((std::uint64_t{1} << hn::Lanes(tag)) - 1U);
}

/// Calls visit(lane) for each set lane, in ascending order.
template <class Tag, class AnyMask, class Visit>
HWY_INLINE void for_each_set(Tag tag, AnyMask mask, Visit&& visit) {
    std::array<std::uint8_t, hn::MaxLanes(Tag()) / 8 + 8> bits{};
    hn::StoreMaskBits(tag, mask, bits.data());
    for (std::size_t lane = 0; lane < hn::Lanes(tag); ++lane) {
        if ((bits[lane / 8] >> (lane % 8) & 1U) != 0) visit(lane);
    }
}

/// The values of a raster at the places of 64 voxels, for as many voxels at a time as AnyTag has lanes. The
/// values are loaded one by one: a processor overlaps many loads, and its gather instructions are not faster,
/// or are much slower.
template <class AnyTag>
class LookUps {
  public:
    using Places = hn::RebindToSigned<AnyTag>;
    HWY_INLINE void put(std::size_t at, hn::Vec<Places> places) {
        hn::Store(places, Places(), places_.data() + at);
    }
    HWY_INLINE void look_up(const float* raster) {
        for (std::size_t at = 0; at < places_.size(); ++at) values_[at] = raster[places_[at]];
    }
    [[nodiscard]] HWY_INLINE hn::Vec<AnyTag> values(std::size_t at) const {
        return hn::Load(AnyTag(), values_.data() + at);
    }

  private:
    alignas(64) std::array<std::int32_t, 64> places_;
    alignas(64) std::array<float, 64> values_;
};

HWY_INLINE Float squared_length_of(Float x, Float y, Float z) {
    return hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z));
}
/// The length of (x, y, z) as OctoMap computes it: in single precision except for the square root.
HWY_INLINE Double length_of(Float x, Float y, Float z) {
    return hn::Sqrt(hn::PromoteTo(Doubles(), squared_length_of(x, y, z)));
}

}  // namespace octoskin::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
