// Compiled once for each instruction set that Highway knows; the best one is chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/core/depth/filtered_row.cpp"
// clang-format off: foreach_target.h comes before highway.h
#include "host/core/depth/filtered_row.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on

#include <algorithm>
#include <array>
#include <cassert>
#include <limits>
#include <utility>

#include "host/core/depth/sorting_network.hpp"

HWY_BEFORE_NAMESPACE();
namespace octoskin::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// One lane per pixel: neighbouring pixels are filtered side by side.
using Shorts = hn::ScalableTag<std::int16_t>;
using Short = hn::Vec<Shorts>;
using Mask = hn::Mask<Shorts>;
/// Half of the lanes at a time.
using Floats = hn::Repartition<float, Shorts>;
using Ints = hn::RebindToSigned<Floats>;
using Halves = hn::Rebind<std::int16_t, Floats>;
using Lanes = std::array<std::int16_t, hn::MaxLanes(Shorts())>;

/// Replaces values outside the gate: it sorts beyond all values inside, and its double fits 16 bits.
constexpr std::int16_t kFar = 16'383;

/// Differences of the values within the gate to the centre, row by row, mm; kFar or -kFar for the others.
template <std::size_t kSide>
struct NearOffsets {
    std::array<Short, kSide * kSide> mm;
    Mask are_even;  ///< the number of values within the gate is even
};

HWY_INLINE Mask is_within(Short value, Short limit) {
    const hn::RebindToUnsigned<Shorts> u;  // |-32768| is 32768
    const auto size = hn::BitCast(u, hn::Abs(value));
    return hn::RebindMask(Shorts(), hn::Eq(hn::Min(size, hn::BitCast(u, limit)), size));
}

/// Values outside the gate become +kFar and -kFar alternately: the median is then in the middle for any
/// number of values.
template <std::size_t kSide>
HWY_INLINE NearOffsets<kSide> near_offsets(const CodedDepth* corner, std::size_t stride, Short centre,
                                           std::int16_t gate_mm) {
    const Shorts s;
    const Short gate = hn::Set(s, gate_mm);
    NearOffsets<kSide> near;
    Short far = hn::Set(s, kFar);
    HWY_UNROLL(49)
    for (std::size_t i = 0; i < kSide * kSide; ++i) {
        const Short value = hn::LoadU(s, corner + i / kSide * stride + i % kSide);
        const Short offset = hn::SaturatedSub(value, centre);
        const Mask is_near = is_within(offset, gate);
        near.mm[i] = hn::IfThenElse(is_near, offset, far);
        far = hn::IfThenElse(is_near, far, hn::Neg(far));
    }
    near.are_even = hn::Lt(far, hn::Zero(s));  // an odd number was replaced, of an odd total
    return near;
}

template <std::size_t kCount>
HWY_INLINE void exchange(std::array<Short, kCount>& values, std::size_t low, std::size_t high) {
    const Short smaller = hn::Min(values[low], values[high]);
    values[high] = hn::Max(values[low], values[high]);
    values[low] = smaller;
}

template <std::size_t kCount, std::size_t... kIndex>
HWY_INLINE void sort_unrolled(std::array<Short, kCount>& values, std::index_sequence<kIndex...>) {
    [[maybe_unused]] constexpr auto kNetwork = sorting_network<kCount>();
    (exchange(values, kNetwork[kIndex].low, kNetwork[kIndex].high), ...);
}

template <std::size_t kCount>
HWY_INLINE void sort(std::array<Short, kCount>& values) {
    static constexpr auto kNetwork = sorting_network<kCount>();
    // Unrolled up to a window of 5. Larger networks take compilers minutes and do not fit into registers.
    if constexpr (kNetwork.size() <= 138) {
        sort_unrolled(values, std::make_index_sequence<kNetwork.size()>());
    } else {
        for (const Exchange& next : kNetwork) exchange(values, next.low, next.high);
    }
}

/// The median in half millimetres from the centre. The code sorts all values; the compiler removes what the
/// middle does not depend on.
template <std::size_t kSide>
HWY_INLINE Short median_of(NearOffsets<kSide> near) {
    constexpr std::size_t kMiddle = kSide * kSide / 2;
    sort(near.mm);
    const Short upper = near.mm[kMiddle];
    if constexpr (kMiddle == 0) {
        return hn::Add(upper, upper);
    } else {
        return hn::Add(upper, hn::IfThenElse(near.are_even, near.mm[kMiddle - 1], upper));
    }
}

/// Sums of one pixel per lane, in half millimetres: the median's difference to the centre; the number of
/// values near the median; and per row the sum of their differences to the median. All are whole numbers, so
/// neither rounding nor the order of the additions matters.
template <std::size_t kSide>
struct WindowSums {
    HWY_ALIGN Lanes centre;
    HWY_ALIGN Lanes median;
    HWY_ALIGN Lanes count;
    HWY_ALIGN std::array<Lanes, kSide> rows;
};

template <std::size_t kSide>
HWY_INLINE void sum_near(const NearOffsets<kSide>& near, Short median, std::int16_t mean_gate_mm2,
                         WindowSums<kSide>& sums) {
    const Shorts s;
    const Short gate = hn::Set(s, mean_gate_mm2);
    Short count = hn::Zero(s);
    HWY_UNROLL(7)
    for (std::size_t row = 0; row < kSide; ++row) {
        Short row_sum = hn::Zero(s);
        HWY_UNROLL(7)
        for (std::size_t column = 0; column < kSide; ++column) {
            const Short mm = near.mm[row * kSide + column];
            const Short offset = hn::SaturatedSub(hn::Add(mm, mm), median);
            const Mask is_near = is_within(offset, gate);
            row_sum = hn::Add(row_sum, hn::IfThenElseZero(is_near, offset));
            count = hn::Sub(count, hn::VecFromMask(s, is_near));
        }
        hn::Store(row_sum, s, sums.rows[row].data());
    }
    hn::Store(median, s, sums.median.data());
    hn::Store(count, s, sums.count.data());
}

/// The means of the pixels from lane `first` on, metres; NaN for no value.
template <std::size_t kSide>
HWY_INLINE hn::Vec<Floats> means_of(const WindowSums<kSide>& sums, std::size_t first,
                                    const FilterWindow& window) {
    const Floats f;
    const auto ints = [first](const Lanes& lanes) {
        return hn::PromoteTo(Ints(), hn::Load(Halves(), lanes.data() + first));
    };
    auto sum = hn::Zero(Ints());
    HWY_UNROLL(7)
    for (const Lanes& row : sums.rows) sum = hn::Add(sum, ints(row));
    const auto centre = ints(sums.centre);
    const auto centre_mm = hn::Sub(centre, hn::Set(Ints(), zero_depth(window)));
    const auto median_mm2 = hn::Add(hn::Add(centre_mm, centre_mm), ints(sums.median));
    const auto support = hn::ConvertTo(f, ints(sums.count));
    const auto mean_mm2 = hn::Add(hn::ConvertTo(f, median_mm2), hn::Div(hn::ConvertTo(f, sum), support));
    constexpr float kPerMetre = 2'000.0F;
    const auto mean_m = hn::Div(mean_mm2, hn::Set(f, kPerMetre));
    const auto is_value = hn::And(hn::Gt(support, hn::Set(f, window.min_support)),
                                  hn::RebindMask(f, hn::Ne(centre, hn::Set(Ints(), kNoDepth))));
    return hn::IfThenElse(is_value, mean_m, hn::Set(f, std::numeric_limits<float>::quiet_NaN()));
}

template <std::size_t kSide>
HWY_INLINE void filter_with(const FilterWindow& window, const WindowedRow& row, float* filtered) {
    const Shorts s;
    const Floats f;
    WindowSums<kSide> sums;
    HWY_ALIGN std::array<float, hn::MaxLanes(Shorts())> means;
    for (std::size_t u = 0; u < row.width; u += hn::Lanes(s)) {
        const std::size_t count = std::min(hn::Lanes(s), row.width - u);
        const CodedDepth* const corner = row.corner + u;
        const Short centre = hn::LoadU(s, corner + kSide / 2 * row.stride + kSide / 2);
        if (hn::AllTrue(s, hn::Eq(centre, hn::Set(s, kNoDepth)))) {
            std::fill_n(filtered + u, count, std::numeric_limits<float>::quiet_NaN());
            continue;
        }
        hn::Store(centre, s, sums.centre.data());
        const auto near = near_offsets<kSide>(corner, row.stride, centre, window.gate_mm);
        sum_near(near, median_of(near), window.mean_gate_mm2, sums);
        for (std::size_t lane = 0; lane < hn::Lanes(s); lane += hn::Lanes(f))
            hn::Store(means_of(sums, lane, window), f, means.data() + lane);
        std::copy_n(means.begin(), count, filtered + u);
    }
}

void filter_row(const FilterWindow& window, const WindowedRow& row, float* filtered) {
    switch (window.side) {
        case 1:
            return filter_with<1>(window, row, filtered);
        case 3:
            return filter_with<3>(window, row, filtered);
        case 5:
            return filter_with<5>(window, row, filtered);
        case 7:
            return filter_with<7>(window, row, filtered);
        default:
            assert(false);
    }
}

}  // namespace octoskin::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace octoskin {
namespace {

HWY_EXPORT(filter_row);

}  // namespace

void filter_row(const FilterWindow& window, const WindowedRow& row, float* filtered) {
    HWY_DYNAMIC_DISPATCH(filter_row)(window, row, filtered);
}

}  // namespace octoskin
#endif
