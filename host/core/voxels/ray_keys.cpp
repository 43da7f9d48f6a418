// Compiled once for each instruction set that Highway knows; the best one is chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/core/voxels/ray_keys.cpp"
// clang-format off: foreach_target.h comes before highway.h
#include "host/core/voxels/ray_keys.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on

#include <array>
#include <cstdint>

#ifndef OCTOSKIN_RAY_KEYS_TYPES
#define OCTOSKIN_RAY_KEYS_TYPES
namespace octoskin {

/// The faces that a ray crosses along one axis, in units of the distance between two: face i at t_first + i *
/// t_step metres from the origin, which is face i + 1 of the voxels' own count.
struct Crossings {
    std::int32_t count = 0;
    std::int32_t first_key = 0;
    std::int32_t sign = 0;
    double t_first = 0.0;
    double t_step = 0.0;
    double per_step = 0.0;        ///< 1 / t_step; 0 for an axis never stepped
    double first_in_steps = 0.0;  ///< t_first / t_step; 1, which is never reached, for an axis never stepped
};
using RayCrossings = std::array<Crossings, 3>;

}  // namespace octoskin
#endif

HWY_BEFORE_NAMESPACE();
namespace octoskin::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Times = hn::ScalableTag<double>;
using Counts = hn::Rebind<std::int32_t, Times>;
using Time = hn::Vec<Times>;
using Count = hn::Vec<Counts>;

/// In steps of an axis. OctoMap adds up the steps, 2^16 of them at most, which rounds a crossing by less than
/// 5e-7 of one.
constexpr double kMargin = 1e-6;

struct Before {
    Count count;
    hn::Mask<Times> is_unsure;
};

/// How many faces along `axis` the ray has crossed before `t`.
HWY_INLINE Before crossed_before(const Crossings& axis, Time t) {
    const Times d;
    const Counts i;
    const Time steps = hn::Sub(hn::Mul(t, hn::Set(d, axis.per_step)), hn::Set(d, axis.first_in_steps));
    const auto is_tie = hn::Lt(hn::Abs(hn::Sub(steps, hn::Round(steps))), hn::Set(d, kMargin));
    const auto is_beyond_last = hn::Gt(steps, hn::Set(d, static_cast<double>(axis.count)));
    const Count count = hn::Add(hn::DemoteTo(i, hn::Floor(steps)), hn::Set(i, 1));
    return {hn::Min(hn::Max(count, hn::Zero(i)), hn::Set(i, axis.count)), hn::Or(is_tie, is_beyond_last)};
}

/// Puts the voxel behind each face into its place. False if that cannot be told of some.
bool place_keys(const RayCrossings& axes, VoxelKey* keys) {
    const Times d;
    const Counts i;
    constexpr std::size_t kLanesMax = hn::MaxLanes(d);
    // Of each axis: how many faces the ray has crossed behind each of the faces at hand.
    alignas(64) std::array<std::array<std::int32_t, kLanesMax>, 3> crossed;
    auto is_unsure = hn::FirstN(d, 0);
    for (std::size_t a = 0; a < 3; ++a) {
        const Crossings& own = axes[a];
        const std::size_t b = (a + 1) % 3;
        const std::size_t c = (a + 2) % 3;
        for (std::int32_t begin = 0; begin < own.count; begin += static_cast<std::int32_t>(hn::Lanes(d))) {
            const Count number = hn::Iota(i, begin);
            const Time t =
                hn::Add(hn::Set(d, own.t_first), hn::Mul(hn::PromoteTo(d, number), hn::Set(d, own.t_step)));
            const Before of_b = crossed_before(axes[b], t);
            const Before of_c = crossed_before(axes[c], t);
            const auto left = static_cast<std::size_t>(own.count - begin);
            is_unsure =
                hn::Or(is_unsure, hn::And(hn::FirstN(d, left), hn::Or(of_b.is_unsure, of_c.is_unsure)));

            hn::Store(hn::Add(number, hn::Set(i, 1)), i, crossed[a].data());
            hn::Store(of_b.count, i, crossed[b].data());
            hn::Store(of_c.count, i, crossed[c].data());
            for (std::size_t lane = 0; lane < hn::Lanes(d) && lane < left; ++lane) {
                const auto key_along = [&](std::size_t axis) {
                    return static_cast<std::uint16_t>(axes[axis].first_key +
                                                      axes[axis].sign * crossed[axis][lane]);
                };
                const std::int32_t place = crossed[0][lane] + crossed[1][lane] + crossed[2][lane];
                keys[place] = {key_along(0), key_along(1), key_along(2)};
            }
        }
    }
    return hn::AllFalse(d, is_unsure);
}

}  // namespace octoskin::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace octoskin {
namespace {

HWY_EXPORT(place_keys);

/// False if the axis leads away from the last voxel, or its last face is crossed where the ray ends, as
/// nearly as OctoMap can tell.
bool take_axis(const Ray& ray, std::size_t axis, std::uint16_t first, std::uint16_t last,
               Crossings& crossings) {
    constexpr double kBeforeEnd = 1.0 - 1e-9;
    const std::int32_t sign = ray.sign[axis];
    const std::int32_t count = (last - first) * sign;
    crossings = {.count = count,
                 .first_key = first,
                 .sign = sign,
                 .t_first = ray.t_next[axis],
                 .t_step = ray.t_step[axis],
                 .per_step = sign == 0 ? 0.0 : 1.0 / ray.t_step[axis],
                 .first_in_steps = sign == 0 ? 1.0 : ray.t_next[axis] / ray.t_step[axis]};
    if (count == 0) return first == last;
    return count > 0 && crossings.t_first + (count - 1) * crossings.t_step <
                            static_cast<double>(ray.length_m) * kBeforeEnd;
}

}  // namespace

void list_ray_keys(const Ray& ray, std::vector<VoxelKey>& keys) {
    keys.clear();
    if (ray.first == ray.last) return;
    RayCrossings axes;
    if (take_axis(ray, 0, ray.first.x, ray.last.x, axes[0]) &&
        take_axis(ray, 1, ray.first.y, ray.last.y, axes[1]) &&
        take_axis(ray, 2, ray.first.z, ray.last.z, axes[2])) {
        // The voxel behind the last face is the last one, which is not visited.
        const auto faces = static_cast<std::size_t>(axes[0].count) + static_cast<std::size_t>(axes[1].count) +
                           static_cast<std::size_t>(axes[2].count);
        keys.resize(faces + 1);
        keys.front() = ray.first;
        if (HWY_DYNAMIC_DISPATCH(place_keys)(axes, keys.data())) {
            keys.pop_back();
            return;
        }
        keys.clear();
    }
    walk_ray_keys(ray, [&](VoxelKey key) { keys.push_back(key); });
}

}  // namespace octoskin
#endif
