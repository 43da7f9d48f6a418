// Compiled once for each instruction set that Highway knows; the best one is chosen at run time. Products and
// sums are never fused, so that all of them give the same bits.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/core/depth/denoised_row.cpp"
// clang-format off: foreach_target.h comes before highway.h
#include "host/core/depth/denoised_row.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on

#include <array>
#include <limits>

HWY_BEFORE_NAMESPACE();
namespace octoskin::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::ScalableTag<float>;
using Float = hn::Vec<Floats>;
using Mask = hn::Mask<Floats>;
using Bytes = hn::Rebind<std::uint8_t, Floats>;

HWY_INLINE Float constant(float value) {
    return hn::Set(Floats(), value);
}
HWY_INLINE Float squared(Float value) {
    return hn::Mul(value, value);
}

HWY_INLINE Float sigma_of(const DenoiserRule& rule, Float depth_m) {
    const Float beyond_m = hn::Sub(depth_m, constant(rule.sigma_from_m));
    return hn::Add(constant(rule.sigma_m), hn::Mul(constant(rule.sigma_per_m), squared(beyond_m)));
}

/// Standard deviation of a new value's difference from the mean of `count` values.
HWY_INLINE Float innovation_sigma(const DenoiserRule& rule, Float mean_m, Float count) {
    const Float one = constant(1.0F);
    return hn::Mul(sigma_of(rule, mean_m), hn::Sqrt(hn::Add(one, hn::Div(one, count))));
}

void find_innovations(const DenoiserRule& rule, const float* depth_m, const PixelMemoryRow& memory,
                      std::size_t width, float* innovations, float* known) {
    const Floats f;
    const Float zero = hn::Zero(f);
    const Float limit = constant(rule.gate_sigmas);
    for (std::size_t u = 0; u < width; u += hn::Lanes(f)) {
        const Float depth = hn::LoadU(f, depth_m + u);
        const Float count = hn::Abs(hn::LoadU(f, memory.count + u));
        const Mask is_known = hn::And(hn::Gt(depth, zero), hn::Gt(count, zero));
        const Float mean = hn::LoadU(f, memory.mean_m + u);
        const Float sigmas = hn::Div(hn::Sub(depth, mean), innovation_sigma(rule, mean, count));
        const Float limited = hn::Min(hn::Max(sigmas, hn::Neg(limit)), limit);
        hn::StoreU(hn::IfThenElseZero(is_known, limited), f, innovations + u);
        hn::StoreU(hn::IfThenElseZero(is_known, constant(1.0F)), f, known + u);
    }
}

void sum_fives(const float* values, std::size_t width, float* sums) {
    const Floats f;
    for (std::size_t u = 0; u < width; u += hn::Lanes(f)) {
        Float sum = hn::LoadU(f, values + u);
        for (std::size_t i = 1; i < kDenoiserSide; ++i) sum = hn::Add(sum, hn::LoadU(f, values + u + i));
        hn::StoreU(sum, f, sums + u);
    }
}

HWY_INLINE Float sum_of_rows(const float* const (&rows)[kDenoiserSide], std::size_t u) {
    Float sum = hn::Zero(Floats());
    for (const float* const row : rows)
        if (row != nullptr) sum = hn::Add(sum, hn::LoadU(Floats(), row + u));
    return sum;
}

/// Inverse depth, variance and weight of a mean of `count` values.
HWY_INLINE void store_posterior(const DenoiserRule& rule, Float mean_m, Float count, Mask has_value,
                                const PosteriorRow& posterior, std::size_t u) {
    const Floats f;
    const Float inverse = hn::Div(constant(1.0F), mean_m);
    const Float squared_inverse = squared(inverse);
    const Float variance_m2 = hn::Div(squared(sigma_of(rule, mean_m)), count);
    const Float variance = hn::Mul(variance_m2, squared(squared_inverse));
    const Float none = constant(std::numeric_limits<float>::quiet_NaN());
    hn::StoreU(hn::IfThenElse(has_value, inverse, none), f, posterior.inverse + u);
    hn::StoreU(hn::IfThenElseZero(has_value, variance), f, posterior.variance + u);
    hn::StoreU(hn::IfThenElseZero(has_value, hn::Div(constant(1.0F), variance)), f, posterior.weight + u);
}

void take_row(const DenoiserRule& rule, float* depth_m, const PooledRows& pooled,
              const PixelMemoryRow& memory, const PixelMemoryRow& next, const PosteriorRow& posterior,
              std::size_t width, std::uint8_t* changes) {
    const Floats f;
    const Float zero = hn::Zero(f);
    const Float one = constant(1.0F);
    for (std::size_t u = 0; u < width; u += hn::Lanes(f)) {
        const Float depth = hn::LoadU(f, depth_m + u);
        const Float mean = hn::LoadU(f, memory.mean_m + u);
        const Float signed_count = hn::LoadU(f, memory.count + u);
        const Float drift = hn::LoadU(f, memory.drift + u);
        const Float count = hn::Abs(signed_count);
        const Mask is_measured = hn::Gt(depth, zero);
        const Mask has_mean = hn::Gt(count, zero);
        const Mask is_both = hn::And(is_measured, has_mean);

        const Float known = hn::Max(sum_of_rows(pooled.known, u), one);
        const Float step = hn::Div(sum_of_rows(pooled.innovations, u), hn::Sqrt(known));
        const Float memory_share = constant(rule.drift_memory);
        const Float drifted =
            hn::Add(hn::Mul(memory_share, drift), hn::Mul(hn::Sub(one, memory_share), step));
        const Mask has_moved = hn::Or(hn::Gt(hn::Abs(step), constant(rule.step_sigmas)),
                                      hn::Gt(hn::Abs(drifted), constant(rule.drift_sigmas)));
        const Float difference = hn::Sub(depth, mean);
        const Float gate = hn::Mul(constant(rule.gate_sigmas), innovation_sigma(rule, mean, count));
        const Mask is_inside = hn::Le(hn::Abs(difference), gate);
        const Mask is_second = hn::AndNot(is_inside, hn::Lt(signed_count, zero));

        const Mask restarts = hn::And(is_both, hn::Or(has_moved, is_second));
        const Mask begins = hn::Or(restarts, hn::AndNot(has_mean, is_measured));
        const Mask agrees = hn::AndNot(restarts, hn::And(is_both, is_inside));
        const Mask is_held = hn::AndNot(restarts, hn::AndNot(is_inside, is_both));

        const Float more = hn::Min(hn::Add(count, one), constant(rule.count_max));
        const Float agreed = hn::Add(mean, hn::Div(difference, more));
        const Float next_mean = hn::IfThenElse(begins, depth, hn::IfThenElse(agrees, agreed, mean));
        const Float next_count = hn::IfThenElse(
            begins, one, hn::IfThenElse(agrees, more, hn::IfThenElse(is_held, hn::Neg(count), signed_count)));
        const Float next_drift = hn::IfThenElse(begins, zero, hn::IfThenElse(is_both, drifted, drift));
        hn::StoreU(next_mean, f, next.mean_m + u);
        hn::StoreU(next_count, f, next.count + u);
        hn::StoreU(next_drift, f, next.drift + u);
        const Mask is_used = hn::Or(begins, agrees);
        hn::StoreU(hn::IfThenElseZero(is_used, depth), f, depth_m + u);
        const Float values = hn::Abs(next_count);
        const Mask has_posterior = hn::Or(is_used, hn::Gt(values, one));  // one value alone may be wrong
        store_posterior(rule, next_mean, values, has_posterior, posterior, u);
        const Mask is_confirmed = hn::And(agrees, hn::Eq(count, one));
        const Float change =
            hn::IfThenElse(restarts, constant(static_cast<float>(kChangeFound)),
                           hn::IfThenElseZero(is_confirmed, constant(static_cast<float>(kChangeConfirmed))));
        hn::StoreU(hn::DemoteTo(Bytes(), hn::ConvertTo(hn::RebindToSigned<Floats>(), change)), Bytes(),
                   changes + u);
    }
}

/// True if the inverse depths of two pixels differ by no more than noise and a slope can explain; false for a
/// pixel without a value. `slope`: for both pixels' distance.
HWY_INLINE Mask is_one_surface(Float difference, Float slope, Float variance, Float sigmas_squared) {
    const Float size = hn::Abs(difference);
    const Mask is_near = hn::Le(squared(hn::Sub(size, slope)), hn::Mul(sigmas_squared, variance));
    return hn::Or(hn::Le(size, slope), is_near);
}

/// One pixel of each lane.
struct Posterior {
    Float inverse;
    Float variance;
    Float weight;
};
HWY_INLINE Posterior posterior_at(const PosteriorRow& row, std::ptrdiff_t u) {
    const Floats f;
    return {hn::LoadU(f, row.inverse + u), hn::LoadU(f, row.variance + u), hn::LoadU(f, row.weight + u)};
}

/// A pixel and what is averaged with it.
class Average {
  public:
    HWY_INLINE Average(const DenoiserRule& rule, const Posterior& centre, std::size_t step)
        : centre_(centre),
          sigmas_squared_(constant(rule.pair_sigmas * rule.pair_sigmas)),
          four_variances_(hn::Mul(constant(4.0F), centre.variance)),
          slope_(hn::Mul(centre.inverse, constant(rule.slope * static_cast<float>(2 * step)))),
          weights(centre.weight),
          sum(hn::Mul(centre.weight, centre.inverse)),
          agreed(hn::Zero(Floats())) {}

    /// Two pixels opposite each other, `sides` steps along rows and columns from the centre.
    HWY_INLINE void add(const Posterior& first, const Posterior& second, float sides) {
        const Float variance = hn::Add(first.variance, second.variance);
        const Float both = hn::Add(first.inverse, second.inverse);
        const Float bend = hn::Sub(both, hn::Add(centre_.inverse, centre_.inverse));
        const Mask is_straight =
            hn::Le(squared(bend), hn::Mul(sigmas_squared_, hn::Add(variance, four_variances_)));
        const Float slope = hn::Mul(slope_, constant(sides));
        const Mask is_pair = hn::And(is_straight, is_one_surface(hn::Sub(first.inverse, second.inverse),
                                                                 slope, variance, sigmas_squared_));
        // At most the reciprocal of the variance of the pair's mean, and equal to it for equal variances.
        const Float less = hn::Min(first.weight, second.weight);
        weights = hn::Add(weights, hn::IfThenElseZero(is_pair, hn::Add(less, less)));
        sum = hn::Add(sum, hn::IfThenElseZero(is_pair, hn::Mul(less, both)));
        agreed = hn::Add(agreed, hn::IfThenElseZero(is_pair, constant(2.0F)));
    }

  private:
    const Posterior& centre_;
    Float sigmas_squared_;
    Float four_variances_;
    Float slope_;

  public:
    Float weights;
    Float sum;
    Float agreed;
};

void average_row(const DenoiserRule& rule, const AveragedRows& rows, std::size_t step, std::size_t width,
                 const PosteriorRow& averaged, float* agreed) {
    const Floats f;
    for (std::size_t u = 0; u < width; u += hn::Lanes(f)) {
        const auto middle = static_cast<std::ptrdiff_t>(u);  // left of the first pixel is the margin
        const std::ptrdiff_t left = middle - static_cast<std::ptrdiff_t>(step);
        const std::ptrdiff_t right = middle + static_cast<std::ptrdiff_t>(step);
        const Posterior centre = posterior_at(rows.centre, middle);
        Average average(rule, centre, step);
        average.add(posterior_at(rows.centre, left), posterior_at(rows.centre, right), 1.0F);
        average.add(posterior_at(rows.above, middle), posterior_at(rows.below, middle), 1.0F);
        average.add(posterior_at(rows.above, left), posterior_at(rows.below, right), 2.0F);
        average.add(posterior_at(rows.above, right), posterior_at(rows.below, left), 2.0F);
        hn::StoreU(hn::Div(average.sum, average.weights), f, averaged.inverse + u);
        hn::StoreU(hn::Div(constant(1.0F), average.weights), f, averaged.variance + u);
        hn::StoreU(average.weights, f, averaged.weight + u);
        if (agreed != nullptr) hn::StoreU(average.agreed, f, agreed + u);
    }
}

/// Pixels of the window that may be of the centre's surface.
HWY_INLINE Float neighbours_of(const DenoiserRule& rule, const WindowRows& rows, std::size_t u) {
    const Floats f;
    const Float sigmas_squared = constant(rule.pair_sigmas * rule.pair_sigmas);
    const Float centre = hn::LoadU(f, rows.inverse[kDenoiserHalf] + u);
    const Float centre_variance = hn::LoadU(f, rows.variance[kDenoiserHalf] + u);
    const Float slope = hn::Mul(centre, constant(rule.slope));
    const auto distance = [](std::size_t a) {
        return a > kDenoiserHalf ? a - kDenoiserHalf : kDenoiserHalf - a;
    };
    Float neighbours = hn::Zero(f);
    for (std::size_t row = 0; row < kDenoiserSide; ++row) {
        for (std::size_t column = 0; column < kDenoiserSide; ++column) {
            const std::size_t steps = distance(row) + distance(column);
            if (steps == 0) continue;
            const std::ptrdiff_t at =
                static_cast<std::ptrdiff_t>(u + column) - static_cast<std::ptrdiff_t>(kDenoiserHalf);
            const Float value = hn::LoadU(f, rows.inverse[row] + at);
            const Float variance = hn::Add(hn::LoadU(f, rows.variance[row] + at), centre_variance);
            const Float slopes = hn::Mul(slope, constant(static_cast<float>(steps)));
            const Mask is_near = is_one_surface(hn::Sub(value, centre), slopes, variance, sigmas_squared);
            neighbours = hn::Add(neighbours, hn::IfThenElseZero(is_near, constant(1.0F)));
        }
    }
    return neighbours;
}

void drop_unsupported(const DenoiserRule& rule, const WindowRows& rows, const float* agreed,
                      const float* count, std::size_t width, float* depth_m) {
    const Floats f;
    const Float support_min = constant(rule.support_min);
    for (std::size_t u = 0; u < width; u += hn::Lanes(f)) {
        const Float depth = hn::LoadU(f, depth_m + u);
        const Mask has_none = hn::Not(hn::Gt(depth, hn::Zero(f)));
        const Float further = hn::Sub(hn::Abs(hn::LoadU(f, count + u)), constant(1.0F));
        Mask is_sure = hn::Ge(hn::Add(further, hn::LoadU(f, agreed + u)), support_min);
        if (!hn::AllTrue(f, hn::Or(has_none, is_sure)))
            is_sure = hn::Or(is_sure, hn::Ge(hn::Add(further, neighbours_of(rule, rows, u)), support_min));
        const Float none = constant(std::numeric_limits<float>::quiet_NaN());
        hn::StoreU(hn::IfThenElse(is_sure, depth, none), f, depth_m + u);
    }
}

void find_doubts(const DenoiserRule& rule, const PosteriorRow& posterior, const float* count, float count_min,
                 std::size_t width, float* doubts_m) {
    const Floats f;
    for (std::size_t u = 0; u < width; u += hn::Lanes(f)) {
        const Float depth = hn::Div(constant(1.0F), hn::LoadU(f, posterior.inverse + u));
        const Float variance = hn::Add(hn::LoadU(f, posterior.variance + u), constant(rule.bias_variance));
        const Float sigma_m = hn::Mul(squared(depth), hn::Sqrt(variance));
        const Mask is_old = hn::Ge(hn::Abs(hn::LoadU(f, count + u)), constant(count_min));
        hn::StoreU(hn::IfThenElseZero(is_old, hn::Mul(constant(rule.doubt_sigmas), sigma_m)), f,
                   doubts_m + u);
    }
}

void replace_depths(const float* inverse, std::size_t width, float* depth_m) {
    const Floats f;
    const Float none = constant(std::numeric_limits<float>::quiet_NaN());
    for (std::size_t u = 0; u < width; u += hn::Lanes(f)) {
        const Mask has_value = hn::Gt(hn::LoadU(f, depth_m + u), hn::Zero(f));
        const Float depth = hn::Div(constant(1.0F), hn::LoadU(f, inverse + u));
        hn::StoreU(hn::IfThenElse(has_value, depth, none), f, depth_m + u);
    }
}

}  // namespace octoskin::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace octoskin {
namespace {

HWY_EXPORT(find_innovations);
HWY_EXPORT(sum_fives);
HWY_EXPORT(take_row);
HWY_EXPORT(average_row);
HWY_EXPORT(drop_unsupported);
HWY_EXPORT(find_doubts);
HWY_EXPORT(replace_depths);

}  // namespace

void find_innovations(const DenoiserRule& rule, const float* depth_m, const PixelMemoryRow& memory,
                      std::size_t width, float* innovations, float* known) {
    HWY_DYNAMIC_DISPATCH(find_innovations)(rule, depth_m, memory, width, innovations, known);
}

void sum_fives(const float* values, std::size_t width, float* sums) {
    HWY_DYNAMIC_DISPATCH(sum_fives)(values, width, sums);
}

void take_row(const DenoiserRule& rule, float* depth_m, const PooledRows& pooled,
              const PixelMemoryRow& memory, const PixelMemoryRow& next, const PosteriorRow& posterior,
              std::size_t width, std::uint8_t* changes) {
    HWY_DYNAMIC_DISPATCH(take_row)(rule, depth_m, pooled, memory, next, posterior, width, changes);
}

void average_row(const DenoiserRule& rule, const AveragedRows& rows, std::size_t step, std::size_t width,
                 const PosteriorRow& averaged, float* agreed) {
    HWY_DYNAMIC_DISPATCH(average_row)(rule, rows, step, width, averaged, agreed);
}

void drop_unsupported(const DenoiserRule& rule, const WindowRows& rows, const float* agreed,
                      const float* count, std::size_t width, float* depth_m) {
    HWY_DYNAMIC_DISPATCH(drop_unsupported)(rule, rows, agreed, count, width, depth_m);
}

void find_doubts(const DenoiserRule& rule, const PosteriorRow& posterior, const float* count, float count_min,
                 std::size_t width, float* doubts_m) {
    HWY_DYNAMIC_DISPATCH(find_doubts)(rule, posterior, count, count_min, width, doubts_m);
}

void replace_depths(const float* inverse, std::size_t width, float* depth_m) {
    HWY_DYNAMIC_DISPATCH(replace_depths)(inverse, width, depth_m);
}

}  // namespace octoskin
#endif
