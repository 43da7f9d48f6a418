// The pixels that see a brick's voxels, many voxels at a time. Included once for each instruction set (see
// Highway's foreach_target.h, which comes before).
#ifndef OCTOSKIN_VOXEL_PIXELS_TYPES
#define OCTOSKIN_VOXEL_PIXELS_TYPES

#include "host/core/traversal/voxel_rays.hpp"

namespace octoskin {

/// Pixels of an image, both ends included; empty if a last one is less than its first.
struct SeenPixels {
    int u_first, u_last, v_first, v_last;
};

}  // namespace octoskin
#endif

#if defined(OCTOSKIN_VOXEL_PIXELS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef OCTOSKIN_VOXEL_PIXELS_INL
#undef OCTOSKIN_VOXEL_PIXELS_INL
#else
#define OCTOSKIN_VOXEL_PIXELS_INL
#endif

#include <hwy/highway.h>

#include "host/core/traversal/lanes-inl.hpp"
#include "host/core/traversal/word_coverage-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace octoskin::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Sixteen lanes at most: the bits of a mask then fit two bytes.
using Tag = hn::CappedTag<float, 16>;
using Lanes = hn::Vec<Tag>;

/// True where a ray at distance (off_x, off_y) from the centre, at its depth, is inside the voxel.
HWY_INLINE auto is_inside(const Kernel& rays, Lanes off_x, Lanes off_y) {
    const Tag f;
    Lanes furthest = hn::Zero(f);
    for (const auto& axis : rays.across) {
        const Lanes along = hn::Add(hn::Mul(off_x, hn::Set(f, axis[0])), hn::Mul(off_y, hn::Set(f, axis[1])));
        furthest = hn::Max(furthest, hn::Abs(along));
    }
    return hn::Lt(furthest, hn::Set(f, rays.inside_m));
}

/// Distance of a pixel's ray from a centre at its depth, along the camera's x or y.
HWY_INLINE Lanes off_by(Lanes pixel, float optical_axis, float per_focal, Lanes z, Lanes centre) {
    const Tag f;
    const Lanes slope = hn::Mul(hn::Sub(pixel, hn::Set(f, optical_axis)), hn::Set(f, per_focal));
    return hn::Sub(hn::Mul(slope, z), centre);
}

/// Columns and rows, one pixel per lane.
struct Pixels {
    Lanes u, v;
};

HWY_INLINE Lanes within(Lanes pixel, float last) {
    const Tag f;
    return hn::Min(hn::Max(pixel, hn::Zero(f)), hn::Set(f, last));
}

/// Indices in a raster of pixels, or of blocks of 2^shift pixels.
template <int kShift>
HWY_INLINE auto places_of(std::uint32_t columns, const Pixels& pixels) {
    const hn::Rebind<std::int32_t, Tag> i;
    const auto row = hn::Mul(hn::ShiftRight<kShift>(hn::ConvertTo(i, pixels.v)),
                             hn::Set(i, static_cast<std::int32_t>(columns)));
    return hn::Add(row, hn::ShiftRight<kShift>(hn::ConvertTo(i, pixels.u)));
}

using WordLookUps = LookUps<Tag>;

/// Centres in the camera's frame, one per lane.
struct Centres {
    Lanes x, y, z;
};

HWY_INLINE Centres centres_of(const Kernel& rays, const Centre& first, std::size_t cell) {
    const Tag f;
    return {hn::Add(hn::Set(f, first.x), hn::LoadU(f, rays.offsets[0].data() + cell)),
            hn::Add(hn::Set(f, first.y), hn::LoadU(f, rays.offsets[1].data() + cell)),
            hn::Add(hn::Set(f, first.z), hn::LoadU(f, rays.offsets[2].data() + cell))};
}

/// Image positions of the centres; a centre nearer than `near_m` is projected as if at `near_m`.
HWY_INLINE Pixels pixels_at(const Kernel& rays, const Centres& centres) {
    const Tag f;
    const Lanes per_z = hn::Div(hn::Set(f, 1.0F), hn::Max(centres.z, hn::Set(f, rays.near_m)));
    const auto seen_at = [&](Lanes across, float focal, float optical_axis) HWY_ATTR {
        return hn::Add(hn::Mul(hn::Mul(across, per_z), hn::Set(f, focal)), hn::Set(f, optical_axis));
    };
    return {seen_at(centres.x, rays.fx, rays.u_centre), seen_at(centres.y, rays.fy, rays.v_centre)};
}

/// Voxels of a word: those in front of the camera, and of them those that the ray of the pixel nearest to
/// their centre passes.
struct Passed {
    std::uint64_t is_before = 0;
    std::uint64_t certainly = 0;
};

/// Without branches, which could not be predicted.
HWY_INLINE Passed ask_nearest(const Kernel& rays, const Centre& first, std::size_t word_cell) {
    const Tag f;
    WordLookUps passed_m;
    Passed passed;
    for (std::size_t bit = 0; bit < 64; bit += hn::Lanes(f)) {
        const Centres centres = centres_of(rays, first, word_cell + bit);
        const Pixels centre = pixels_at(rays, centres);
        // For a centre outside the image the nearest pixel is at the border, and possibly too far away.
        const Pixels nearest{within(hn::Round(centre.u), rays.last_u),
                             within(hn::Round(centre.v), rays.last_v)};
        passed_m.put(bit, places_of<0>(rays.width, nearest));
        const auto is_in =
            is_inside(rays, off_by(nearest.u, rays.u_centre, rays.per_fx, centres.z, centres.x),
                      off_by(nearest.v, rays.v_centre, rays.per_fy, centres.z, centres.y));
        const auto is_before = hn::Gt(centres.z, hn::Set(f, rays.near_m));
        passed.is_before |= bits_of(f, is_before) << bit;
        passed.certainly |= bits_of(f, hn::And(is_before, is_in)) << bit;
    }
    passed_m.look_up(rays.passed_m);
    std::uint64_t goes_on = 0;
    for (std::size_t bit = 0; bit < 64; bit += hn::Lanes(f)) {
        const Lanes z = centres_of(rays, first, word_cell + bit).z;
        goes_on |= bits_of(f, hn::Gt(passed_m.values(bit), hn::Add(z, hn::Set(f, rays.margin_m)))) << bit;
    }
    passed.certainly &= goes_on;
    return passed;
}

/// For each voxel of a word, the pixels whose rays are within `half_m` of its centre at its depth, along the
/// camera's x and y.
class NearPixels {
  public:
    HWY_INLINE void put(std::size_t bit, const Kernel& rays, const Pixels& centre, Lanes z, float half_m) {
        const Tag f;
        const Lanes half = hn::Div(hn::Set(f, half_m), hn::Max(z, hn::Set(f, rays.near_m)));
        put(bit, rays, centre, {hn::Mul(half, hn::Set(f, rays.fx)), hn::Mul(half, hn::Set(f, rays.fy))});
    }
    /// The pixels up to `half` from the centre's image.
    HWY_INLINE void put(std::size_t bit, const Kernel& rays, const Pixels& centre, const Pixels& half) {
        const Tag f;
        const hn::Rebind<std::int32_t, Tag> i;
        const auto store = [&](Lanes pixel, auto& pixels)
                               HWY_ATTR { hn::Store(hn::ConvertTo(i, pixel), i, pixels.data() + bit); };
        // Outside the image, a first pixel is behind the last column or row, or a last one before the first.
        const auto first = [&](Lanes at, float last) HWY_ATTR {
            return hn::Min(hn::Ceil(hn::Max(at, hn::Zero(f))), hn::Set(f, last + 1.0F));
        };
        const auto last_of = [&](Lanes at, float last) HWY_ATTR {
            return hn::Max(hn::Floor(hn::Min(at, hn::Set(f, last))), hn::Set(f, -1.0F));
        };
        store(first(hn::Sub(centre.u, half.u), rays.last_u), u_first_);
        store(last_of(hn::Add(centre.u, half.u), rays.last_u), u_last_);
        store(first(hn::Sub(centre.v, half.v), rays.last_v), v_first_);
        store(last_of(hn::Add(centre.v, half.v), rays.last_v), v_last_);
    }
    [[nodiscard]] HWY_INLINE SeenPixels of(unsigned bit) const {
        return {u_first_[bit], u_last_[bit], v_first_[bit], v_last_[bit]};
    }

  private:
    alignas(64) std::array<std::int32_t, 64> u_first_, u_last_, v_first_, v_last_;
};

HWY_INLINE Lanes loaded(const Kernel& rays, const float* values, int u, int v) {
    return hn::LoadU(Tag(), values + static_cast<std::size_t>(v) * rays.width + static_cast<std::size_t>(u));
}

}  // namespace octoskin::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
