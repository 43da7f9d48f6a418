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

/// So many neighbouring pixels are filtered side by side, a lane each.
using Floats = hn::ScalableTag<float>;
using Ints = hn::RebindToSigned<Floats>;
using Float = hn::Vec<Floats>;
using Int = hn::Vec<Ints>;
using Mask = hn::Mask<Floats>;

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

/// The values near the centre, row by row; infinity in place of the others.
template <std::size_t kSide>
struct NearValues {
    std::array<Float, kSide * kSide> depth_m;
    Mask are_even;  ///< how many they are
};

/// What is not near becomes +infinity and -infinity by turns: then the median is in the middle however many
/// there are.
template <std::size_t kSide>
HWY_INLINE NearValues<kSide> near_values(const float* corner, std::size_t stride, Float centre,
                                         float gate_m) {
    const Floats f;
    const Float gate = hn::Set(f, gate_m);
    const Float sign = hn::SignBit(f);
    NearValues<kSide> near;
    Float far = hn::Set(f, std::numeric_limits<float>::infinity());
    HWY_UNROLL(49)
    for (std::size_t i = 0; i < kSide * kSide; ++i) {
        const Float value = hn::LoadU(f, corner + i / kSide * stride + i % kSide);
        const Mask is_near = hn::Le(hn::Abs(hn::Sub(value, centre)), gate);  // false if either is a NaN
        near.depth_m[i] = hn::IfThenElse(is_near, value, far);
        far = hn::Xor(far, hn::IfThenZeroElse(is_near, sign));
    }
    near.are_even = hn::Lt(far, hn::Zero(f));  // of the odd number of values an odd number was replaced
    return near;
}

template <std::size_t kCount>
HWY_INLINE void exchange(std::array<Float, kCount>& values, std::size_t low, std::size_t high) {
    const Float smaller = hn::Min(values[low], values[high]);
    values[high] = hn::Max(values[low], values[high]);
    values[low] = smaller;
}

template <std::size_t kCount, std::size_t... kIndex>
HWY_INLINE void sort_unrolled(std::array<Float, kCount>& values, std::index_sequence<kIndex...>) {
    [[maybe_unused]] constexpr auto kNetwork = sorting_network<kCount>();
    (exchange(values, kNetwork[kIndex].low, kNetwork[kIndex].high), ...);
}

template <std::size_t kCount>
HWY_INLINE void sort(std::array<Float, kCount>& values) {
    static constexpr auto kNetwork = sorting_network<kCount>();
    // In one piece up to a window of 5: what is larger takes compilers minutes, and does not fit registers.
    if constexpr (kNetwork.size() <= 138) {
        sort_unrolled(values, std::make_index_sequence<kNetwork.size()>());
    } else {
        for (const Exchange& next : kNetwork) exchange(values, next.low, next.high);
    }
}

/// Sorted completely by its text; the compiler leaves out what the middle does not depend on.
template <std::size_t kSide>
HWY_INLINE Float median_of(NearValues<kSide> near) {
    constexpr std::size_t kMiddle = kSide * kSide / 2;
    sort(near.depth_m);
    const Float upper = near.depth_m[kMiddle];
    if constexpr (kMiddle == 0) {
        return upper;
    } else {
        const Float lower = hn::IfThenElse(near.are_even, near.depth_m[kMiddle - 1], upper);
        return hn::Mul(hn::Set(Floats(), 0.5F), hn::Add(lower, upper));
    }
}

/// Offsets from the median are added row by row, each row from its left, then the sums of the rows.
template <std::size_t kSide>
HWY_INLINE Float mean_near(Float median, const NearValues<kSide>& near, float gate_m, float min_support) {
    const Floats f;
    const Ints n;
    const Float gate = hn::Set(f, gate_m);
    Float offset_sum = hn::Zero(f);
    Int count = hn::Zero(n);
    HWY_UNROLL(7)
    for (std::size_t row = 0; row < kSide; ++row) {
        Float row_sum = hn::Zero(f);
        HWY_UNROLL(7)
        for (std::size_t column = 0; column < kSide; ++column) {
            const Float offset = hn::Sub(near.depth_m[row * kSide + column], median);
            const Mask is_near = hn::Le(hn::Abs(offset), gate);
            row_sum = hn::Add(row_sum, hn::IfThenElseZero(is_near, offset));
            count = hn::Sub(count, hn::VecFromMask(n, hn::RebindMask(n, is_near)));
        }
        offset_sum = hn::Add(offset_sum, row_sum);
    }
    const Float support = hn::ConvertTo(f, count);
    const Float mean = hn::Add(median, hn::Div(offset_sum, support));
    return hn::IfThenElse(hn::Gt(support, hn::Set(f, min_support)), mean, hn::Set(f, kNone));
}

template <std::size_t kSide>
HWY_INLINE void filter_with(const FilterWindow& window, const WindowedRow& row, float* filtered) {
    const Floats f;
    const std::size_t lanes = hn::Lanes(f);
    const auto store = [&](Float values, std::size_t u) {
        if (u + lanes <= row.width) {
            hn::StoreU(values, f, filtered + u);
        } else {
            HWY_ALIGN std::array<float, hn::MaxLanes(Floats())> last;
            hn::Store(values, f, last.data());
            std::copy_n(last.begin(), row.width - u, filtered + u);
        }
    };
    for (std::size_t u = 0; u < row.width; u += lanes) {
        const float* const corner = row.corner + u;
        const Float centre = hn::LoadU(f, corner + kSide / 2 * row.stride + kSide / 2);
        if (hn::AllTrue(f, hn::IsNaN(centre))) {
            store(centre, u);
            continue;
        }
        const auto near = near_values<kSide>(corner, row.stride, centre, window.gate_m);
        store(mean_near(median_of(near), near, window.mean_gate_m, window.min_support), u);
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
