// Decides on a brick's eight words of 4 x 4 x 4 voxels without testing single voxels. Included once for each
// instruction set (see Highway's foreach_target.h, which comes before).
#ifndef OCTOSKIN_WORD_VERDICTS_TYPES
#define OCTOSKIN_WORD_VERDICTS_TYPES

#include "host/core/traversal/voxel_rays.hpp"

namespace octoskin {

/// A voxel's centre in the camera's frame.
struct Centre {
    float x, y, z;
};

}  // namespace octoskin
#endif

#if defined(OCTOSKIN_WORD_VERDICTS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef OCTOSKIN_WORD_VERDICTS_INL
#undef OCTOSKIN_WORD_VERDICTS_INL
#else
#define OCTOSKIN_WORD_VERDICTS_INL
#endif

#include <hwy/highway.h>

#include "host/core/traversal/lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace octoskin::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using Kernel = VoxelRays::Kernel;

// One lane for each word of a BrickMask, or for a part of the words.
using WordTag = hn::CappedTag<float, 8>;
using WordInts = hn::RebindToSigned<WordTag>;
using Words = hn::Vec<WordTag>;

/// One bit for each of the eight words of a brick: words with all voxels passed, and words with none passed.
struct WordCoverage {
    std::uint32_t all = 0;
    std::uint32_t none = 0;
};

/// First and last pixel, of a row or column, whose rays count for one of 64 voxels.
struct Seen {
    Words first, last;
};

/// `reach_m`: from the middle to the furthest place of such a ray.
HWY_INLINE Seen seen_of(Words middle, float reach_m, Words per_nearest, Words per_furthest, float focal,
                        float optical_axis) {
    const WordTag f;
    const Words reach = hn::Set(f, reach_m);
    const Words low = hn::Sub(middle, reach);
    const Words high = hn::Add(middle, reach);
    const auto pixel = [&](Words slope) {
        return hn::Add(hn::Mul(slope, hn::Set(f, focal)), hn::Set(f, optical_axis));
    };
    constexpr float kRounding_px = 0.01F;
    return {hn::Sub(pixel(hn::Min(hn::Mul(low, per_nearest), hn::Mul(low, per_furthest))),
                    hn::Set(f, kRounding_px)),
            hn::Add(pixel(hn::Max(hn::Mul(high, per_nearest), hn::Mul(high, per_furthest))),
                    hn::Set(f, kRounding_px))};
}

HWY_INLINE auto block_of(Words pixel, float last) {
    const WordTag f;
    static_assert(RangePyramid::kBlock == 2);
    const Words inside = hn::Min(hn::Max(pixel, hn::Zero(f)), hn::Set(f, last));
    return hn::ShiftRight<1>(hn::ConvertTo(WordInts(), inside));
}

/// Decides on the words without testing single voxels. `first`: the centre of the brick's first voxel.
HWY_INLINE WordCoverage judge_words(const Kernel& rays, const Centre& first) {
    const WordTag f;
    const WordInts i;
    WordCoverage verdicts;
    for (std::size_t word = 0; word < 8; word += hn::Lanes(f)) {
        const Words x = hn::Add(hn::Set(f, first.x), hn::LoadU(f, rays.middles[0].data() + word));
        const Words y = hn::Add(hn::Set(f, first.y), hn::LoadU(f, rays.middles[1].data() + word));
        const Words z = hn::Add(hn::Set(f, first.z), hn::LoadU(f, rays.middles[2].data() + word));
        const Words half_depth = hn::Set(f, rays.word_depth_m);
        const Words nearest = hn::Sub(z, half_depth);
        const Words furthest = hn::Add(z, half_depth);
        const Words near = hn::Set(f, rays.near_m);
        const auto is_before = hn::Gt(nearest, near);
        const Words per_nearest = hn::Div(hn::Set(f, 1.0F), hn::Max(nearest, near));
        const Words per_furthest = hn::Div(hn::Set(f, 1.0F), hn::Max(furthest, near));
        const Seen u = seen_of(x, rays.word_x_m, per_nearest, per_furthest, rays.fx, rays.u_centre);
        const Seen v = seen_of(y, rays.word_y_m, per_nearest, per_furthest, rays.fy, rays.v_centre);
        const Words zero = hn::Zero(f);
        const Words last_u = hn::Set(f, rays.last_u);
        const Words last_v = hn::Set(f, rays.last_v);
        const auto is_beside = hn::Or(hn::Or(hn::Lt(u.last, zero), hn::Gt(u.first, last_u)),
                                      hn::Or(hn::Lt(v.last, zero), hn::Gt(v.first, last_v)));
        const auto is_whole = hn::And(hn::And(hn::Ge(u.first, zero), hn::Le(u.last, last_u)),
                                      hn::And(hn::Ge(v.first, zero), hn::Le(v.last, last_v)));

        const auto u_first = block_of(u.first, rays.last_u);
        const auto u_last = block_of(u.last, rays.last_u);
        const auto v_first = block_of(v.first, rays.last_v);
        const auto v_last = block_of(v.last, rays.last_v);
        // Two windows cover twice their length.
        const auto size = hn::Max(hn::Sub(u_last, u_first), hn::Sub(v_last, v_first));
        const auto size_max = static_cast<std::uint32_t>(hn::GetLane(hn::MaxOfLanes(i, size))) + 1;
        const std::uint32_t level =
            size_max < 3 ? 0 : 31U - static_cast<std::uint32_t>(__builtin_clz(size_max - 1));
        if (level >= RangePyramid::kLevels) {
            verdicts.none |= static_cast<std::uint32_t>(bits_of(f, hn::And(is_before, is_beside)) << word);
            continue;
        }
        const auto edge = hn::Set(i, 1 << level);
        const auto u_second = hn::Max(hn::Sub(hn::Add(u_last, hn::Set(i, 1)), edge), hn::Zero(i));
        const auto v_second = hn::Max(hn::Sub(hn::Add(v_last, hn::Set(i, 1)), edge), hn::Zero(i));
        const auto width = hn::Set(i, static_cast<std::int32_t>(rays.blocks_width));
        const auto row_first = hn::Mul(v_first, width);
        const auto row_second = hn::Mul(v_second, width);
        const auto at = {hn::Add(row_first, u_first), hn::Add(row_first, u_second),
                         hn::Add(row_second, u_first), hn::Add(row_second, u_second)};
        Words shortest = hn::Set(f, 1e30F);
        Words longest = hn::Set(f, -1.0F);
        for (const auto& block : at) {
            shortest = hn::Min(shortest, hn::GatherIndex(f, rays.shortest_m[level], block));
            longest = hn::Max(longest, hn::GatherIndex(f, rays.longest_m[level], block));
        }
        const auto is_beyond = hn::Or(is_beside, hn::Le(longest, nearest));
        const auto is_seen = hn::And(is_whole, hn::Le(furthest, hn::Set(f, rays.depth_max_m)));
        const auto is_passed =
            hn::And(is_seen, hn::Gt(shortest, hn::Add(furthest, hn::Set(f, rays.margin_m))));
        verdicts.none |= static_cast<std::uint32_t>(bits_of(f, hn::And(is_before, is_beyond)) << word);
        verdicts.all |= static_cast<std::uint32_t>(bits_of(f, hn::And(is_before, is_passed)) << word);
    }
    return verdicts;
}

}  // namespace octoskin::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
