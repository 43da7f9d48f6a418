// Compiled once for each instruction set that Highway knows; the best one is chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/core/self_filter/axis_distances.cpp"
// clang-format off: foreach_target.h comes before highway.h
#include "host/core/self_filter/axis_distances.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace octoskin::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

RowOutcome remove_in_row(const RoughCapsule& capsule, std::size_t count, RowOfPixels& row) {
    const hn::CappedTag<float, 16> f;
    const auto zero = hn::Zero(f);
    const auto one = hn::Set(f, 1.0F);
    const auto inside = hn::Set(f, capsule.inside_m2);
    const auto outside = hn::Set(f, capsule.outside_m2);
    const auto none = hn::NaN(f);
    RowOutcome outcome;
    for (std::size_t i = 0; i < count; i += hn::Lanes(f)) {
        const auto z = hn::LoadU(f, row.depth_m.data() + i);
        const auto from_x = hn::MulSub(hn::LoadU(f, row.x.data() + i), z, hn::Set(f, capsule.a.x()));
        const auto from_y = hn::MulSub(hn::LoadU(f, row.y.data() + i), z, hn::Set(f, capsule.a.y()));
        const auto from_z = hn::Sub(z, hn::Set(f, capsule.a.z()));
        auto along = hn::Mul(from_x, hn::Set(f, capsule.per_length.x()));
        along = hn::MulAdd(from_y, hn::Set(f, capsule.per_length.y()), along);
        along = hn::MulAdd(from_z, hn::Set(f, capsule.per_length.z()), along);
        along = hn::Min(hn::Max(along, zero), one);
        const auto off_x = hn::NegMulAdd(along, hn::Set(f, capsule.axis.x()), from_x);
        const auto off_y = hn::NegMulAdd(along, hn::Set(f, capsule.axis.y()), from_y);
        const auto off_z = hn::NegMulAdd(along, hn::Set(f, capsule.axis.z()), from_z);
        const auto squared = hn::MulAdd(off_x, off_x, hn::MulAdd(off_y, off_y, hn::Mul(off_z, off_z)));
        hn::StoreU(squared, f, row.squared_m2.data() + i);
        const auto may_be_in = hn::And(hn::Le(squared, outside), hn::FirstN(f, count - i));
        if (hn::AllFalse(f, may_be_in)) continue;
        const auto is_in = hn::And(may_be_in, hn::Le(squared, inside));
        hn::StoreU(hn::IfThenElse(is_in, none, z), f, row.depth_m.data() + i);
        const std::size_t removed = hn::CountTrue(f, is_in);
        outcome.removed += removed;
        outcome.is_unsure |= removed != hn::CountTrue(f, may_be_in);
    }
    return outcome;
}

}  // namespace octoskin::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace octoskin {
namespace {

HWY_EXPORT(remove_in_row);
constexpr std::size_t kLanesMax = 16;
constexpr double kPoint_m = 1e-6;

}  // namespace

RoughCapsule::RoughCapsule(const PosedCapsule& capsule, double radius_m)
    : a(capsule.p_a.cast<float>()), axis((capsule.p_b - capsule.p_a).cast<float>()) {
    const Eigen::Vector3d along = capsule.p_b - capsule.p_a;
    // The direction of a shorter axis does not matter.
    if (along.norm() > kPoint_m) per_length = (along / along.squaredNorm()).cast<float>();
    // About a dozen roundings of 6e-8 each, of numbers that near the surface are at most this large.
    const double extent_m = capsule.p_a.norm() + capsule.p_b.norm() + radius_m;
    const double unsure_m = kPoint_m + 1e-5 * extent_m;
    const double inner_m = radius_m - unsure_m;
    inside_m2 = inner_m > 0.0 ? static_cast<float>(inner_m * inner_m) : -1.0F;
    outside_m2 = static_cast<float>((radius_m + unsure_m) * (radius_m + unsure_m));
}

RowOfPixels::RowOfPixels(std::size_t width)
    : x(width + kLanesMax), y(x.size()), depth_m(x.size()), squared_m2(x.size()) {}

RowOutcome remove_certain(const RoughCapsule& capsule, std::size_t count, RowOfPixels& row) {
    return HWY_DYNAMIC_DISPATCH(remove_in_row)(capsule, count, row);
}

}  // namespace octoskin
#endif
