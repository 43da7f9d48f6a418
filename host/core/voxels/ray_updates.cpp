// Compiled once for each instruction set that Highway knows; the best one is chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/core/voxels/ray_updates.cpp"
// clang-format off: foreach_target.h comes before highway.h
#include "host/core/voxels/ray_updates.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

#ifndef OCTOSKIN_RAY_KEYS_TYPES
#define OCTOSKIN_RAY_KEYS_TYPES
namespace octoskin {

/// The faces that a ray crosses along one axis: face i is at t_first + i * t_step metres from the origin.
struct Crossings {
    std::int32_t count = 0;
    double t_first = 0.0;
    double t_step = 0.0;
    double per_step = 0.0;        ///< 1 / t_step; 0 for an axis never stepped
    double first_in_steps = 0.0;  ///< t_first / t_step; for an axis never stepped anything between 0 and 1
    double key_step = 0.0;        ///< what one step adds to a packed key
};

/// Keys are packed into one number with 16 bits per axis, x lowest. A double represents it exactly.
struct RayCrossings {
    std::array<Crossings, 3> axes;
    double first_key = 0.0;
};

/// Writes the key and the gap behind it together.
inline void put(VoxelUpdate& update, std::int64_t packed_key, float log_odds) {
    static_assert(offsetof(VoxelUpdate, key) == 0 && offsetof(VoxelUpdate, log_odds) == sizeof packed_key);
    std::memcpy(static_cast<void*>(&update), &packed_key, sizeof packed_key);
    update.log_odds = log_odds;
}

}  // namespace octoskin
#endif

HWY_BEFORE_NAMESPACE();
namespace octoskin::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Times = hn::CappedTag<double, 8>;
using Places = hn::Rebind<std::int32_t, Times>;
using Keys = hn::Rebind<std::int64_t, Times>;
using Time = hn::Vec<Times>;

/// In steps of an axis. OctoMap adds up to 2^16 steps, which rounds a crossing by less than 5e-7 of a step.
constexpr double kMargin = 1e-6;

/// Detects where rounding makes it uncertain how many faces of another axis were crossed before those of one
/// axis.
struct Doubts {
    // In steps, to the next face of the other axis.
    Time least;
    Time most;
    hn::Mask<Times> is_beyond_last;
};

/// How many faces along `axis` the ray has crossed before `t`.
HWY_INLINE Time crossed_before(const Crossings& axis, Time t, Doubts& doubts) {
    const Times d;
    const Time steps = hn::MulSub(t, hn::Set(d, axis.per_step), hn::Set(d, axis.first_in_steps));
    const Time count = hn::Ceil(steps);
    const Time until_next = hn::Sub(count, steps);
    doubts.least = hn::Min(doubts.least, until_next);
    doubts.most = hn::Max(doubts.most, until_next);
    const Time count_max = hn::Set(d, static_cast<double>(axis.count));
    doubts.is_beyond_last = hn::Or(doubts.is_beyond_last, hn::Gt(count, count_max));
    return hn::Min(hn::Max(count, hn::Zero(d)), count_max);
}

/// Writes the voxels behind the faces of one axis, `own`, to their places in the order.
HWY_INLINE void place_behind(const Crossings& own, const Crossings& b, const Crossings& c, double first_key,
                             Doubts& doubts, float log_odds, VoxelUpdate* updates) {
    const Times d;
    const Places i;
    const Keys k;
    constexpr std::size_t kLanesMax = hn::MaxLanes(d);
    const Time last = hn::Set(d, static_cast<double>(own.count - 1));
    for (std::int32_t begin = 0; begin < own.count; begin += static_cast<std::int32_t>(hn::Lanes(d))) {
        // Lanes beyond the last face repeat that face.
        const Time number = hn::Min(hn::Iota(d, static_cast<double>(begin)), last);
        const Time t = hn::MulAdd(number, hn::Set(d, own.t_step), hn::Set(d, own.t_first));
        const Time of_own = hn::Add(number, hn::Set(d, 1.0));
        const Time of_b = crossed_before(b, t, doubts);
        const Time of_c = crossed_before(c, t, doubts);
        const Time place = hn::Add(hn::Add(of_own, of_b), of_c);
        Time key = hn::MulAdd(of_own, hn::Set(d, own.key_step), hn::Set(d, first_key));
        key = hn::MulAdd(of_b, hn::Set(d, b.key_step), key);
        key = hn::MulAdd(of_c, hn::Set(d, c.key_step), key);
        alignas(64) std::array<std::int32_t, kLanesMax> places;
        alignas(64) std::array<std::int64_t, kLanesMax> packed;
        hn::Store(hn::DemoteTo(i, place), i, places.data());
        hn::Store(hn::ConvertTo(k, key), k, packed.data());
        for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane)
            put(updates[places[lane]], packed[lane], log_odds);
    }
}

/// Writes the voxel behind each face to its place. False if the order of some voxels is uncertain.
bool place_updates(const RayCrossings& ray, float log_odds, VoxelUpdate* updates) {
    const Times d;
    Doubts doubts{hn::Set(d, 0.5), hn::Set(d, 0.5), hn::FirstN(d, 0)};
    const auto& [x, y, z] = ray.axes;
    place_behind(x, y, z, ray.first_key, doubts, log_odds, updates);
    place_behind(y, z, x, ray.first_key, doubts, log_odds, updates);
    place_behind(z, x, y, ray.first_key, doubts, log_odds, updates);
    const auto is_tie =
        hn::Or(hn::Lt(doubts.least, hn::Set(d, kMargin)), hn::Gt(doubts.most, hn::Set(d, 1.0 - kMargin)));
    return hn::AllFalse(d, hn::Or(is_tie, doubts.is_beyond_last));
}

}  // namespace octoskin::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace octoskin {
namespace {

HWY_EXPORT(place_updates);

/// False if the axis leads away from the last voxel, or if OctoMap's arithmetic may not reach the axis' last
/// face before the ray ends.
bool take_axis(const Ray& ray, std::size_t axis, std::uint16_t first, std::uint16_t last,
               RayCrossings& crossings) {
    constexpr double kBeforeEnd = 1.0 - 1e-9;
    const std::int32_t sign = ray.sign[axis];
    const std::int32_t count = (last - first) * sign;
    const auto key_unit = static_cast<double>(std::int64_t{1} << (16 * axis));
    crossings.axes[axis] = {.count = count,
                            .t_first = ray.t_next[axis],
                            .t_step = ray.t_step[axis],
                            .per_step = sign == 0 ? 0.0 : 1.0 / ray.t_step[axis],
                            .first_in_steps = sign == 0 ? 0.5 : ray.t_next[axis] / ray.t_step[axis],
                            .key_step = sign * key_unit};
    crossings.first_key += first * key_unit;
    if (count == 0) return first == last;
    return count > 0 &&
           ray.t_next[axis] + (count - 1) * ray.t_step[axis] < static_cast<double>(ray.length_m) * kBeforeEnd;
}

}  // namespace

std::span<VoxelUpdate> list_ray_updates(const Ray& ray, float log_odds, std::vector<VoxelUpdate>& buffer) {
    const auto most = static_cast<std::size_t>(ray.steps_max) + 2;
    if (buffer.size() < most) buffer.resize(most);
    if (ray.first == ray.last) return {buffer.data(), 0};
    RayCrossings crossings;
    if (take_axis(ray, 0, ray.first.x, ray.last.x, crossings) &&
        take_axis(ray, 1, ray.first.y, ray.last.y, crossings) &&
        take_axis(ray, 2, ray.first.z, ray.last.z, crossings)) {
        std::size_t faces = 0;
        for (const Crossings& axis : crossings.axes) faces += static_cast<std::size_t>(axis.count);
        buffer.front() = {ray.first, log_odds};
        // The voxel behind the last face is the ray's last one, which is not visited.
        if (HWY_DYNAMIC_DISPATCH(place_updates)(crossings, log_odds, buffer.data()))
            return {buffer.data(), faces};
    }
    std::size_t count = 0;
    walk_ray_keys(ray, [&](VoxelKey key) { buffer[count++] = {key, log_odds}; });
    return {buffer.data(), count};
}

}  // namespace octoskin
#endif
