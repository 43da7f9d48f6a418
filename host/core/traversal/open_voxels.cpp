// Compiled once for each instruction set that Highway knows; the best one is chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/core/traversal/open_voxels.cpp"
// clang-format off: foreach_target.h comes before highway.h
#include "host/core/traversal/open_voxels.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on

#include <algorithm>
#include <array>
#include <limits>

#include "host/core/traversal/lanes-inl.hpp"

#ifndef OCTOSKIN_OPEN_VOXELS_TYPES
#define OCTOSKIN_OPEN_VOXELS_TYPES
namespace octoskin {

/// A value for each axis of the map.
using AlongAxes = std::array<float, 3>;

/// The rays of an image from the camera: the direction of pixel (u, v), per metre of depth, is first + u *
/// next_u + v * next_v.
struct RayField {
    AlongAxes first;
    AlongAxes next_u;
    AlongAxes next_v;
    const float* reach_m = nullptr;
    std::uint32_t width = 0;
};

/// A voxel relative to the camera, slightly shrunk and slightly enlarged; metres.
struct AskedVoxel {
    AlongAxes centre;  ///< from the camera
    /// 1 or -1 along an axis if this voxel is above or below the origin's voxel, else 0: a ray in the
    /// opposite direction never reaches it, whatever the rounding.
    AlongAxes side;
    float half_smaller = 0.0F;
    float half_larger = 0.0F;
    float margin_m = 0.0F;
    float nearest_m = 0.0F;  ///< depths of the enlarged voxel
    float furthest_m = 0.0F;
};

/// Pixels along each edge of a tile.
constexpr std::uint32_t kTile = 16;

}  // namespace octoskin
#endif

HWY_BEFORE_NAMESPACE();
namespace octoskin::HWY_NAMESPACE {

using Wide = hn::ScalableTag<float>;
using WideVec = hn::Vec<Wide>;
using WideMask = hn::Mask<Wide>;
using Directions = std::array<WideVec, 3>;

/// The rays whose lines meet the voxel certainly, and possibly, for any length.
struct Meeting {
    WideMask surely;
    WideMask perhaps;
};

/// A line meets a box unless the two are separated in a projection along an axis that is perpendicular to the
/// line and to an edge.
HWY_INLINE Meeting meeting_of(const AskedVoxel& voxel, const Directions& directions) {
    const Wide f;
    Meeting meeting{hn::FirstN(f, hn::Lanes(f)), hn::FirstN(f, hn::Lanes(f))};
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3;
        const WideVec aside = hn::Abs(hn::Sub(hn::Mul(hn::Set(f, voxel.centre[i]), directions[j]),
                                              hn::Mul(hn::Set(f, voxel.centre[j]), directions[i])));
        const WideVec width = hn::Add(hn::Abs(directions[i]), hn::Abs(directions[j]));
        meeting.surely =
            hn::And(meeting.surely, hn::Lt(aside, hn::Mul(hn::Set(f, voxel.half_smaller), width)));
        meeting.perhaps =
            hn::And(meeting.perhaps, hn::Le(aside, hn::Mul(hn::Set(f, voxel.half_larger), width)));
    }
    return meeting;
}

/// Result of some rays for a voxel: whether one certainly passes it, else which possibly do.
struct RayCoverage {
    bool is_passed = false;
    WideMask perhaps;
};

/// For rays that end near the voxel, and for voxels near the camera.
HWY_INLINE RayCoverage coverage_by_distance(const AskedVoxel& voxel, const Directions& directions,
                                            WideMask asked, WideVec reach) {
    const Wide f;
    const WideVec margin = hn::Set(f, voxel.margin_m);
    auto in_smaller = margin;
    auto in_larger = hn::Zero(f);
    auto out_smaller = hn::Set(f, std::numeric_limits<float>::infinity());
    auto out_larger = out_smaller;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const WideVec direction = directions[axis];
        const WideVec per_direction = hn::Div(
            hn::Set(f, 1.0F), hn::CopySign(hn::Max(hn::Abs(direction), hn::Set(f, 1e-9F)), direction));
        const WideVec middle = hn::Mul(hn::Set(f, voxel.centre[axis]), per_direction);
        const WideVec smaller = hn::Mul(hn::Set(f, voxel.half_smaller), hn::Abs(per_direction));
        const WideVec larger = hn::Mul(hn::Set(f, voxel.half_larger), hn::Abs(per_direction));
        in_smaller = hn::Max(in_smaller, hn::Sub(middle, smaller));
        out_smaller = hn::Min(out_smaller, hn::Add(middle, smaller));
        in_larger = hn::Max(in_larger, hn::Sub(middle, larger));
        out_larger = hn::Min(out_larger, hn::Add(middle, larger));
    }
    const WideMask is_in = hn::And(asked, hn::Lt(in_smaller, out_smaller));
    // A ray that ends in a voxel does not pass it.
    const WideMask is_end = hn::And(is_in, hn::And(hn::Gt(reach, hn::Add(in_smaller, margin)),
                                                   hn::Lt(reach, hn::Sub(out_smaller, margin))));
    const WideMask may_pass =
        hn::And(hn::Le(in_larger, out_larger), hn::Ge(hn::Add(reach, margin), in_larger));
    return {!hn::AllFalse(f, hn::And(is_in, hn::Gt(reach, hn::Add(out_larger, margin)))),
            hn::AndNot(is_end, hn::And(asked, may_pass))};
}

/// True if the ray of a pixel of the row certainly passes the voxel. Otherwise adds the rays that possibly
/// pass it to `perhaps`.
HWY_INLINE bool is_passed_in_row(const RayField& rays, const AskedVoxel& voxel, const PixelBox& box,
                                 std::uint32_t v, std::vector<std::uint32_t>& perhaps) {
    const Wide f;
    const std::uint32_t row = v * rays.width;
    Directions first, next;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        first[axis] = hn::Set(f, rays.first[axis] + static_cast<float>(v) * rays.next_v[axis]);
        next[axis] = hn::Set(f, rays.next_u[axis]);
    }
    for (std::uint32_t u = box.u_first; u <= box.u_last; u += static_cast<std::uint32_t>(hn::Lanes(f))) {
        const WideVec reach = hn::LoadU(f, rays.reach_m + row + u);
        const auto reaches =
            hn::And(hn::FirstN(f, box.u_last + 1 - u), hn::Ge(reach, hn::Set(f, voxel.nearest_m)));
        if (hn::AllFalse(f, reaches)) continue;
        const WideVec at = hn::Iota(f, static_cast<float>(u));
        Directions directions;
        for (std::size_t axis = 0; axis < 3; ++axis)
            directions[axis] = hn::Add(first[axis], hn::Mul(at, next[axis]));
        RayCoverage coverage{false, reaches};
        if (voxel.nearest_m > 0.0F) {
            const Meeting meeting = meeting_of(voxel, directions);
            const WideMask goes_on = hn::Gt(reach, hn::Set(f, voxel.furthest_m));
            coverage.is_passed = !hn::AllFalse(f, hn::And(hn::And(reaches, meeting.surely), goes_on));
            coverage.perhaps = hn::And(reaches, meeting.perhaps);
        }
        if (!coverage.is_passed && !hn::AllFalse(f, coverage.perhaps))
            coverage = coverage_by_distance(voxel, directions, coverage.perhaps, reach);
        if (coverage.is_passed) return true;
        if (hn::AllFalse(f, coverage.perhaps)) continue;
        WideMask may_pass = coverage.perhaps;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            constexpr float kStill = -1e-5F;  // with the error of single precision
            may_pass = hn::And(may_pass, hn::Ge(hn::Mul(directions[axis], hn::Set(f, voxel.side[axis])),
                                                hn::Set(f, kStill)));
        }
        for_each_set(f, may_pass, [&](std::size_t lane) {
            perhaps.push_back(row + u + static_cast<std::uint32_t>(lane));
        });
    }
    return false;
}

/// Tests adjacent tiles of the image from pixel (u, v) on, one per lane: true where a ray may meet the voxel.
HWY_INLINE WideMask may_meet(const RayField& rays, const AskedVoxel& voxel, std::uint32_t u,
                             std::uint32_t v) {
    const Wide f;
    constexpr float kHalf_px = 0.5F * kTile;
    const WideVec at =
        hn::MulAdd(hn::Iota(f, 0.0F), hn::Set(f, float{kTile}), hn::Set(f, static_cast<float>(u) + kHalf_px));
    Directions directions;  // directions of the tiles' centres
    AlongAxes off;          // largest deviation from them
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const float in_row = rays.first[axis] + (static_cast<float>(v) + kHalf_px) * rays.next_v[axis];
        directions[axis] = hn::Add(hn::Set(f, in_row), hn::Mul(at, hn::Set(f, rays.next_u[axis])));
        const auto size = [](float value) { return value < 0.0F ? -value : value; };
        off[axis] = kHalf_px * (size(rays.next_u[axis]) + size(rays.next_v[axis]));
    }
    WideMask may = hn::FirstN(f, hn::Lanes(f));
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3;
        const WideVec c_i = hn::Set(f, voxel.centre[i]);
        const WideVec c_j = hn::Set(f, voxel.centre[j]);
        const WideVec aside = hn::Abs(hn::Sub(hn::Mul(c_i, directions[j]), hn::Mul(c_j, directions[i])));
        const WideVec nearer =
            hn::Add(hn::Mul(hn::Abs(c_i), hn::Set(f, off[j])), hn::Mul(hn::Abs(c_j), hn::Set(f, off[i])));
        const WideVec width =
            hn::Add(hn::Add(hn::Abs(directions[i]), hn::Abs(directions[j])), hn::Set(f, off[i] + off[j]));
        may = hn::And(may, hn::Le(hn::Sub(aside, nearer), hn::Mul(hn::Set(f, voxel.half_larger), width)));
    }
    return may;
}

/// For a voxel that many pixels may see: tests tiles of pixels first.
bool is_passed_in_tiles(const RayField& rays, const AskedVoxel& voxel, const PixelBox& box,
                        std::vector<std::uint32_t>& perhaps) {
    const Wide f;
    const auto lanes = static_cast<std::uint32_t>(hn::Lanes(f));
    const auto least = [](std::uint32_t a, std::uint32_t b) { return a < b ? a : b; };
    for (std::uint32_t v = box.v_first; v <= box.v_last; v += kTile) {
        for (std::uint32_t u = box.u_first; u <= box.u_last; u += kTile * lanes) {
            std::uint64_t met = bits_of(f, may_meet(rays, voxel, u, v));
            for (; met != 0; met &= met - 1) {
                const std::uint32_t u_first = u + kTile * static_cast<std::uint32_t>(__builtin_ctzll(met));
                if (u_first > box.u_last) break;
                const PixelBox tile{u_first, least(u_first + kTile - 1, box.u_last), v,
                                    least(v + kTile - 1, box.v_last)};
                for (std::uint32_t row = tile.v_first; row <= tile.v_last; ++row) {
                    if (is_passed_in_row(rays, voxel, tile, row, perhaps)) return true;
                }
            }
        }
    }
    return false;
}

/// Works outwards from the row `middle`, where rays that pass are found soonest.
bool is_passed(const RayField& rays, const AskedVoxel& voxel, const PixelBox& box, std::uint32_t middle,
               std::vector<std::uint32_t>& perhaps) {
    if (box.v_last - box.v_first > 2 * kTile) return is_passed_in_tiles(rays, voxel, box, perhaps);
    const std::uint32_t below = box.v_last - middle;
    const std::uint32_t above = middle - box.v_first;
    if (is_passed_in_row(rays, voxel, box, middle, perhaps)) return true;
    for (std::uint32_t off = 1; off <= (below > above ? below : above); ++off) {
        if (off <= below && is_passed_in_row(rays, voxel, box, middle + off, perhaps)) return true;
        if (off <= above && is_passed_in_row(rays, voxel, box, middle - off, perhaps)) return true;
    }
    return false;
}

}  // namespace octoskin::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace octoskin {
namespace {

HWY_EXPORT(is_passed);

AlongAxes along_axes(const Eigen::Vector3d& p) {
    return {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())};
}

}  // namespace

OpenVoxels::OpenVoxels(const CertainView& view, const ProjectedImage& image, const VoxelLattice& lattice,
                       const BrickVisibility& picture)
    : view_(view),
      image_(image),
      picture_(picture),
      origin_(image.origin.cast<double>()),
      centre_of_origin_(lattice.centre_of(*lattice.key_of(origin_))),
      half_depth_m_(view.half_depth_m + view.margin_m) {
    const CameraIntrinsics& camera = view.camera;
    const Eigen::Matrix3d R_map_camera = view.T_camera_map.linear().transpose();
    const Eigen::Vector3d corner((0.5 - camera.cx) / camera.fx, (0.5 - camera.cy) / camera.fy, 1.0);
    first_ = R_map_camera * corner;
    next_u_ = R_map_camera.col(0) / camera.fx;
    next_v_ = R_map_camera.col(1) / camera.fy;
}

bool OpenVoxels::is_passed(const Eigen::Vector3d& centre_map, std::vector<RayPiece>& pieces) {
    const Eigen::Vector3d centre = view_.T_camera_map * centre_map;
    const auto box = picture_.pixels_of_voxel(centre);
    if (!box) return false;
    const double nearest_m = centre.z() - half_depth_m_;
    if (static_cast<double>(picture_.longest(*box)) < nearest_m) return false;

    const double half_edge_m = 0.5 * view_.resolution_m;
    AskedVoxel voxel{.centre = along_axes(centre_map - origin_),
                     .side = {},
                     .half_smaller = static_cast<float>(half_edge_m - view_.margin_m),
                     .half_larger = static_cast<float>(half_edge_m + view_.margin_m),
                     .margin_m = static_cast<float>(view_.margin_m),
                     .nearest_m = static_cast<float>(nearest_m),
                     .furthest_m = static_cast<float>(centre.z() + half_depth_m_)};
    for (Eigen::Index i = 0; i < 3; ++i) {
        const double away = centre_map[i] - centre_of_origin_[i];
        voxel.side[static_cast<std::size_t>(i)] = away > half_edge_m    ? 1.0F
                                                  : away < -half_edge_m ? -1.0F
                                                                        : 0.0F;
    }
    const RayField rays{along_axes(first_), along_axes(next_u_), along_axes(next_v_), image_.reach_m.data(),
                        image_.width};
    const double v_middle =
        view_.camera.fy * centre.y() / std::max(centre.z(), half_edge_m) + view_.camera.cy;
    const auto middle = static_cast<std::uint32_t>(std::clamp<double>(v_middle, box->v_first, box->v_last));
    perhaps_.clear();
    if (HWY_DYNAMIC_DISPATCH(is_passed)(rays, voxel, *box, middle, perhaps_)) return true;
    const float from_m = std::max(voxel.nearest_m, 0.0F);
    const float to_m = std::max(voxel.furthest_m, static_cast<float>(half_depth_m_));
    for (const std::uint32_t pixel : perhaps_) {
        if (from_m < image_.reach_m[pixel]) pieces.push_back({pixel, from_m, to_m});
    }
    return false;
}

}  // namespace octoskin
#endif
