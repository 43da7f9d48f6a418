// Tests all rays that see a voxel for which the pixel nearest to its centre gives no decision. Included once
// for each instruction set (see Highway's foreach_target.h, which comes before).
#ifndef OCTOSKIN_OPEN_VOXEL_TYPES
#define OCTOSKIN_OPEN_VOXEL_TYPES

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "host/core/traversal/passed_voxels.hpp"

namespace octoskin {

/// A voxel relative to the camera, slightly shrunk and slightly enlarged; metres.
struct AskedVoxel {
    AlongAxes centre{};  ///< from the camera, along the map's axes
    /// 1 or -1 along an axis if this voxel is above or below the origin's voxel, else 0: a ray in the
    /// opposite direction never reaches it, whatever the rounding.
    AlongAxes side{};
    float nearest_m = 0.0F;  ///< depths of the enlarged voxel
    float furthest_m = 0.0F;
    double number = 0.0;  ///< in VoxelNumbers
};

/// Pixels along each edge of a tile.
constexpr int kTile = 16;

}  // namespace octoskin
#endif

#if defined(OCTOSKIN_OPEN_VOXEL_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef OCTOSKIN_OPEN_VOXEL_INL
#undef OCTOSKIN_OPEN_VOXEL_INL
#else
#define OCTOSKIN_OPEN_VOXEL_INL
#endif

#include <hwy/highway.h>

#include "host/core/traversal/lanes-inl.hpp"
#include "host/core/traversal/voxel_pixels-inl.hpp"
#include "host/core/traversal/walkers-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace octoskin::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using Exact = PassedVoxels::Kernel;
using Directions = std::array<Lanes, 3>;
inline constexpr std::size_t kRow = hn::MaxLanes(Tag());

/// The rays whose lines meet the voxel certainly, and possibly, for any length.
struct Meeting {
    hn::Mask<Tag> surely;
    hn::Mask<Tag> perhaps;
};

/// A line meets a box unless the two are separated in a projection along an axis that is perpendicular to the
/// line and to an edge. `centres`: of the boxes, from the camera.
HWY_INLINE Meeting meeting_of(const Exact& exact, const Directions& centres, const Directions& directions) {
    const Tag f;
    Meeting meeting{hn::FirstN(f, hn::Lanes(f)), hn::FirstN(f, hn::Lanes(f))};
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3;
        const Lanes aside =
            hn::Abs(hn::Sub(hn::Mul(centres[i], directions[j]), hn::Mul(centres[j], directions[i])));
        const Lanes width = hn::Add(hn::Abs(directions[i]), hn::Abs(directions[j]));
        meeting.surely =
            hn::And(meeting.surely, hn::Lt(aside, hn::Mul(hn::Set(f, exact.half_smaller_m), width)));
        meeting.perhaps =
            hn::And(meeting.perhaps, hn::Le(aside, hn::Mul(hn::Set(f, exact.half_larger_m), width)));
    }
    return meeting;
}

/// Result of some rays for a voxel: whether one certainly passes it, else which possibly do.
struct PassedBy {
    bool is_passed = false;
    hn::Mask<Tag> perhaps;
};

/// For rays that end near the voxel, and for voxels near the camera.
HWY_INLINE PassedBy coverage_by_distance(const Exact& exact, const AskedVoxel& voxel,
                                         const Directions& directions, hn::Mask<Tag> asked, Lanes reach) {
    const Tag f;
    const Lanes margin = hn::Set(f, exact.pixels.margin_m);
    auto in_smaller = margin;
    auto in_larger = hn::Zero(f);
    auto out_smaller = hn::Set(f, std::numeric_limits<float>::infinity());
    auto out_larger = out_smaller;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const Lanes direction = directions[axis];
        const Lanes per_direction = hn::Div(
            hn::Set(f, 1.0F), hn::CopySign(hn::Max(hn::Abs(direction), hn::Set(f, 1e-9F)), direction));
        const Lanes middle = hn::Mul(hn::Set(f, voxel.centre[axis]), per_direction);
        const Lanes smaller = hn::Mul(hn::Set(f, exact.half_smaller_m), hn::Abs(per_direction));
        const Lanes larger = hn::Mul(hn::Set(f, exact.half_larger_m), hn::Abs(per_direction));
        in_smaller = hn::Max(in_smaller, hn::Sub(middle, smaller));
        out_smaller = hn::Min(out_smaller, hn::Add(middle, smaller));
        in_larger = hn::Max(in_larger, hn::Sub(middle, larger));
        out_larger = hn::Min(out_larger, hn::Add(middle, larger));
    }
    const hn::Mask<Tag> is_in = hn::And(asked, hn::Lt(in_smaller, out_smaller));
    // A ray that ends in a voxel does not pass it.
    const hn::Mask<Tag> is_end = hn::And(is_in, hn::And(hn::Gt(reach, hn::Add(in_smaller, margin)),
                                                        hn::Lt(reach, hn::Sub(out_smaller, margin))));
    const hn::Mask<Tag> may_pass =
        hn::And(hn::Le(in_larger, out_larger), hn::Ge(hn::Add(reach, margin), in_larger));
    return {!hn::AllFalse(f, hn::And(is_in, hn::Gt(reach, hn::Add(out_larger, margin)))),
            hn::AndNot(is_end, hn::And(asked, may_pass))};
}

/// Walks rays that possibly pass a voxel.
class PerhapsPassing {
  public:
    PerhapsPassing(const Exact& exact, const AskedVoxel& voxel)
        : exact_(exact),
          number_(voxel.number),
          from_m_(voxel.nearest_m > 0.0F ? voxel.nearest_m : 0.0F),
          to_m_(voxel.furthest_m > exact.half_depth_m ? voxel.furthest_m : exact.half_depth_m) {}

    /// Adds the ray of a pixel. True if one of the rays is found to pass the voxel.
    HWY_INLINE bool add(std::uint32_t pixel) {
        if (exact_.pixels.reach_m[pixel] <= from_m_) return false;
        pieces_[count_++] = {pixel, from_m_, to_m_};
        return count_ == pieces_.size() && do_pass();
    }
    /// True if a ray that was added passes the voxel.
    [[nodiscard]] HWY_INLINE bool end() { return count_ > 0 && do_pass(); }

  private:
    HWY_NOINLINE bool do_pass() {
        const std::size_t count = count_;
        count_ = 0;
        const hn::Mask<Doubles> undecided = walk(count);
        if (has_passed_) return true;
        // From its origin on a ray is walked exactly as in OctoMap, without a doubt.
        for_each_set(Doubles(), undecided, [&](std::size_t lane) {
            if (lane < count) pieces_[count_++] = {pieces_[lane].pixel, 0.0F, kToEnd};
        });
        if (count_ > 0) (void)walk(count_);
        count_ = 0;
        return has_passed_;
    }
    hn::Mask<Doubles> walk(std::size_t count) {
        const Doubles d;
        auto passed = hn::FirstN(d, 0);
        const auto visit = [&](Double number, Mask is_there) HWY_ATTR {
            passed = hn::Or(passed, hn::And(is_there, hn::Eq(number, hn::Set(d, number_))));
        };
        Walkers walkers(exact_.walk, pieces_.data(), count, visit);
        while (!walkers.have_ended()) walkers.step();
        has_passed_ = has_passed_ || !hn::AllFalse(d, passed);
        return walkers.is_undecided();
    }

    static constexpr float kToEnd = std::numeric_limits<float>::infinity();
    const Exact& exact_;
    double number_;
    float from_m_;
    float to_m_;
    bool has_passed_ = false;
    std::size_t count_ = 0;
    std::array<RayPiece, hn::MaxLanes(Doubles())> pieces_{};
};

/// Pixels of an image in a vector's lanes: kWidth of each row, as many rows as fit.
template <std::size_t kWidth>
class PixelRows {
  public:
    static constexpr int rows() { return static_cast<int>(hn::MaxLanes(Tag()) / kWidth); }

    /// The reaches of the pixels from (u, v) on; those of rows behind `v_last` are undefined.
    static HWY_INLINE Lanes reaches(const VoxelRays::Kernel& rays, int u, int v,
                                    [[maybe_unused]] int v_last) {
        if constexpr (rows() == 1) return loaded(rays, rays.reach_m, u, v);
#if HWY_TARGET != HWY_SCALAR  // whose vectors have no parts
        const Tag f;
        const hn::Half<Tag> half;
        const auto row = [&](auto tag, int k)
                             HWY_ATTR { return hn::LoadU(tag, at(rays, u, std::min(v + k, v_last))); };
        if constexpr (rows() == 2) {
            return hn::Combine(f, row(half, 1), row(half, 0));
        } else if constexpr (rows() == 4) {
            const hn::Half<decltype(half)> quarter;
            return hn::Combine(f, hn::Combine(half, row(quarter, 3), row(quarter, 2)),
                               hn::Combine(half, row(quarter, 1), row(quarter, 0)));
        }
#endif
    }
    /// The column of each lane, from the first on.
    static HWY_INLINE Lanes columns() {
        return hn::Sub(hn::Iota(Tag(), 0.0F), row_starts());
    }
    /// The row of each lane, from the first on.
    static HWY_INLINE Lanes in_rows() {
        return hn::Mul(row_starts(), hn::Set(Tag(), 1.0F / kWidth));
    }
    static HWY_INLINE int pixel(const VoxelRays::Kernel& rays, int u, int v, std::size_t lane) {
        const auto row = static_cast<int>(lane / kWidth);
        return (v + row) * static_cast<int>(rays.width) + u + static_cast<int>(lane % kWidth);
    }

  private:
    static HWY_INLINE const float* at(const VoxelRays::Kernel& rays, int u, int v) {
        return rays.reach_m + static_cast<std::size_t>(v) * rays.width + static_cast<std::size_t>(u);
    }
    static HWY_INLINE Lanes row_starts() {
        const Tag f;
        const Lanes lane = hn::Iota(f, 0.0F);
        return hn::Mul(hn::Floor(hn::Mul(lane, hn::Set(f, 1.0F / kWidth))), hn::Set(f, float{kWidth}));
    }
};

/// True if one of these rays, whose reaches are beyond the voxel's nearest depth, is found to pass it. Adds
/// those that possibly pass it to `perhaps`, by pixel_of(lane).
template <class PixelOf>
HWY_INLINE bool do_rays_pass(const Exact& exact, const AskedVoxel& voxel, const Directions& directions,
                             Lanes reach, hn::Mask<Tag> reaches, PerhapsPassing& perhaps,
                             const PixelOf& pixel_of) {
    const Tag f;
    PassedBy passed{false, reaches};
    if (voxel.nearest_m > 0.0F) {
        const Directions centres{hn::Set(f, voxel.centre[0]), hn::Set(f, voxel.centre[1]),
                                 hn::Set(f, voxel.centre[2])};
        const Meeting meeting = meeting_of(exact, centres, directions);
        const auto goes_on = hn::Gt(reach, hn::Set(f, voxel.furthest_m));
        passed.is_passed = !hn::AllFalse(f, hn::And(hn::And(reaches, meeting.surely), goes_on));
        passed.perhaps = hn::And(reaches, meeting.perhaps);
    }
    if (!passed.is_passed && !hn::AllFalse(f, passed.perhaps))
        passed = coverage_by_distance(exact, voxel, directions, passed.perhaps, reach);
    if (passed.is_passed) return true;
    if (hn::AllFalse(f, passed.perhaps)) return false;
    auto may_pass = passed.perhaps;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        constexpr float kStill = -1e-5F;  // with the error of single precision
        may_pass = hn::And(
            may_pass, hn::Ge(hn::Mul(directions[axis], hn::Set(f, voxel.side[axis])), hn::Set(f, kStill)));
    }
    bool is_found = false;
    for_each_set(f, may_pass, [&](std::size_t lane) {
        is_found = is_found || perhaps.add(static_cast<std::uint32_t>(pixel_of(lane)));
    });
    return is_found;
}

/// True if the ray of one of some pixels is found to pass the voxel.
template <std::size_t kWidth>
HWY_INLINE bool is_passed_in(const Exact& exact, const AskedVoxel& voxel, const SeenPixels& seen,
                             PerhapsPassing& perhaps) {
    const Tag f;
    using Rows = PixelRows<kWidth>;
    const auto lanes = static_cast<int>(kWidth);
    const Lanes columns = Rows::columns();
    const Lanes rows = Rows::in_rows();
    Directions off;
    for (std::size_t axis = 0; axis < 3; ++axis)
        off[axis] = hn::Add(hn::Mul(columns, hn::Set(f, exact.next_u[axis])),
                            hn::Mul(rows, hn::Set(f, exact.next_v[axis])));
    for (int v = seen.v_first; v <= seen.v_last; v += Rows::rows()) {
        for (int u = seen.u_first; u <= seen.u_last; u += lanes) {
            const Lanes reach = Rows::reaches(exact.pixels, u, v, seen.v_last);
            const auto is_seen = hn::And(hn::Le(columns, hn::Set(f, static_cast<float>(seen.u_last - u))),
                                         hn::Le(rows, hn::Set(f, static_cast<float>(seen.v_last - v))));
            const auto reaches = hn::And(is_seen, hn::Ge(reach, hn::Set(f, voxel.nearest_m)));
            if (hn::AllFalse(f, reaches)) continue;
            Directions directions;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const float first = exact.first[axis] + static_cast<float>(u) * exact.next_u[axis] +
                                    static_cast<float>(v) * exact.next_v[axis];
                directions[axis] = hn::Add(hn::Set(f, first), off[axis]);
            }
            const auto pixel_of = [&](std::size_t lane) { return Rows::pixel(exact.pixels, u, v, lane); };
            if (do_rays_pass(exact, voxel, directions, reach, reaches, perhaps, pixel_of)) return true;
        }
    }
    return false;
}

/// Combines all rows in one test, because no ray reaches many of the voxels.
template <std::size_t kWidth>
HWY_INLINE bool is_reached_in(const VoxelRays::Kernel& rays, float nearest_m, const SeenPixels& seen) {
    const Tag f;
    using Rows = PixelRows<kWidth>;
    for (int u = seen.u_first; u <= seen.u_last; u += static_cast<int>(kWidth)) {
        Lanes longest = hn::Set(f, -1.0F);
        for (int v = seen.v_first; v <= seen.v_last; v += Rows::rows())
            longest = hn::Max(longest, Rows::reaches(rays, u, v, seen.v_last));
        const auto in_row = hn::Le(Rows::columns(), hn::Set(f, static_cast<float>(seen.u_last - u)));
        if (!hn::AllFalse(f, hn::And(in_row, hn::Ge(longest, hn::Set(f, nearest_m))))) return true;
    }
    return false;
}

/// Tests adjacent tiles of the image from pixel (u, v) on, one per lane: true where a ray may meet the voxel.
HWY_INLINE hn::Mask<Tag> may_meet(const Exact& exact, const AskedVoxel& voxel, int u, int v) {
    const Tag f;
    constexpr float kHalf_px = 0.5F * kTile;
    const Lanes at = hn::MulAdd(hn::Iota(f, 0.0F), hn::Set(f, static_cast<float>(kTile)),
                                hn::Set(f, static_cast<float>(u) + kHalf_px));
    Directions directions;  // directions of the tiles' centres
    AlongAxes off;          // largest deviation from them
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const float in_row = exact.first[axis] + (static_cast<float>(v) + kHalf_px) * exact.next_v[axis];
        directions[axis] = hn::Add(hn::Set(f, in_row), hn::Mul(at, hn::Set(f, exact.next_u[axis])));
        const auto size = [](float value) { return value < 0.0F ? -value : value; };
        off[axis] = kHalf_px * (size(exact.next_u[axis]) + size(exact.next_v[axis]));
    }
    hn::Mask<Tag> may = hn::FirstN(f, hn::Lanes(f));
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3;
        const Lanes c_i = hn::Set(f, voxel.centre[i]);
        const Lanes c_j = hn::Set(f, voxel.centre[j]);
        const Lanes aside = hn::Abs(hn::Sub(hn::Mul(c_i, directions[j]), hn::Mul(c_j, directions[i])));
        const Lanes nearer =
            hn::Add(hn::Mul(hn::Abs(c_i), hn::Set(f, off[j])), hn::Mul(hn::Abs(c_j), hn::Set(f, off[i])));
        const Lanes width =
            hn::Add(hn::Add(hn::Abs(directions[i]), hn::Abs(directions[j])), hn::Set(f, off[i] + off[j]));
        may = hn::And(may, hn::Le(hn::Sub(aside, nearer), hn::Mul(hn::Set(f, exact.half_larger_m), width)));
    }
    return may;
}

/// For a voxel that many pixels may see: tests tiles of pixels first.
HWY_NOINLINE bool is_passed_in_tiles(const Exact& exact, const AskedVoxel& voxel, const SeenPixels& seen,
                                     PerhapsPassing& perhaps) {
    const Tag f;
    for (int v = seen.v_first; v <= seen.v_last; v += kTile) {
        for (int u = seen.u_first; u <= seen.u_last; u += kTile * static_cast<int>(hn::Lanes(f))) {
            std::uint64_t met = bits_of(f, may_meet(exact, voxel, u, v));
            for (; met != 0; met &= met - 1) {
                const int u_first = u + kTile * __builtin_ctzll(met);
                if (u_first > seen.u_last) break;
                const SeenPixels tile{u_first, std::min(u_first + kTile - 1, seen.u_last), v,
                                      std::min(v + kTile - 1, seen.v_last)};
                if (is_passed_in<kRow>(exact, voxel, tile, perhaps)) return true;
            }
        }
    }
    return false;
}

/// Calls ask(width) with the narrowest rows of a vector that contain all columns.
template <class Ask>
HWY_INLINE bool with_width(const SeenPixels& seen, const Ask& ask) {
    const int width = seen.u_last - seen.u_first + 1;
    if constexpr (kRow >= 8) {
        if (width <= 4) return ask(std::integral_constant<std::size_t, 4>());
    }
    if constexpr (kRow >= 16) {
        if (width <= 8) return ask(std::integral_constant<std::size_t, 8>());
    }
    return ask(std::integral_constant<std::size_t, kRow>());
}

HWY_INLINE bool is_large(const SeenPixels& seen) {
    return seen.v_last - seen.v_first > 2 * kTile;
}

/// False if no ray of the pixels reaches this depth.
HWY_INLINE bool is_reached(const VoxelRays::Kernel& rays, float nearest_m, const SeenPixels& seen) {
    return with_width(seen,
                      [&](auto width) HWY_ATTR { return is_reached_in<width()>(rays, nearest_m, seen); });
}

/// True if a ray passes the voxel.
HWY_INLINE bool is_passed(const Exact& exact, const AskedVoxel& voxel, const SeenPixels& seen) {
    PerhapsPassing perhaps(exact, voxel);
    if (is_large(seen)) return is_passed_in_tiles(exact, voxel, seen, perhaps) || perhaps.end();
    const bool is_found = with_width(
        seen, [&](auto width) HWY_ATTR { return is_passed_in<width()>(exact, voxel, seen, perhaps); });
    return is_found || perhaps.end();
}

}  // namespace octoskin::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
