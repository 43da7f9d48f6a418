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

/// A voxel as pixels in a row see it: its faces along each axis of the map, from the camera, metres, the
/// voxel made a little smaller and a little larger; and the directions of the row's rays, those of its first
/// pixel and what each next one adds, per metre of depth.
struct RowOfRays {
    std::array<float, 3> centre;
    std::array<float, 3> first;
    std::array<float, 3> next;
    /// 1 or -1 along an axis on whose upper or lower side of the origin's voxel this one lies, else 0: a ray
    /// that goes the other way never comes there, whatever is rounded.
    std::array<float, 3> side;
    float half_smaller = 0.0F;
    float half_larger = 0.0F;
    float margin_m = 0.0F;
};

}  // namespace octoskin
#endif

HWY_BEFORE_NAMESPACE();
namespace octoskin::HWY_NAMESPACE {

using Wide = hn::ScalableTag<float>;

/// Does the ray of a pixel, `first` to `last` of the row, pass the voxel for certain? Else adds to `perhaps`
/// those that perhaps do.
bool is_passed(const RowOfRays& row, const float* reach_m, std::uint32_t first, std::uint32_t last,
               std::uint32_t pixel_of_row, std::vector<std::uint32_t>& perhaps) {
    const Wide f;
    const auto lanes = static_cast<std::uint32_t>(hn::Lanes(f));
    for (std::uint32_t u = first; u <= last; u += lanes) {
        const auto at = hn::Iota(f, static_cast<float>(u));
        auto in_smaller = hn::Set(f, row.margin_m);
        auto in_larger = hn::Zero(f);
        auto out_smaller = hn::Set(f, std::numeric_limits<float>::infinity());
        auto out_larger = out_smaller;
        auto may_pass = hn::FirstN(f, last + 1 - u);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const auto direction =
                hn::Add(hn::Set(f, row.first[axis]), hn::Mul(at, hn::Set(f, row.next[axis])));
            const auto per_direction = hn::Div(
                hn::Set(f, 1.0F), hn::CopySign(hn::Max(hn::Abs(direction), hn::Set(f, 1e-9F)), direction));
            constexpr float kStill = -1e-5F;  // and what single precision may make of it
            may_pass =
                hn::And(may_pass, hn::Ge(hn::Mul(direction, hn::Set(f, row.side[axis])), hn::Set(f, kStill)));
            const auto middle = hn::Mul(hn::Set(f, row.centre[axis]), per_direction);
            const auto smaller = hn::Mul(hn::Set(f, row.half_smaller), hn::Abs(per_direction));
            const auto larger = hn::Mul(hn::Set(f, row.half_larger), hn::Abs(per_direction));
            in_smaller = hn::Max(in_smaller, hn::Sub(middle, smaller));
            out_smaller = hn::Min(out_smaller, hn::Add(middle, smaller));
            in_larger = hn::Max(in_larger, hn::Sub(middle, larger));
            out_larger = hn::Min(out_larger, hn::Add(middle, larger));
        }
        const auto reach = hn::LoadU(f, reach_m + pixel_of_row + u);
        if (!hn::AllFalse(f,
                          hn::And(hn::FirstN(f, last + 1 - u),
                                  hn::And(hn::Lt(in_smaller, out_smaller),
                                          hn::Gt(reach, hn::Add(out_larger, hn::Set(f, row.margin_m))))))) {
            return true;
        }
        may_pass = hn::And(may_pass, hn::And(hn::Le(in_larger, out_larger),
                                             hn::Ge(hn::Add(reach, hn::Set(f, row.margin_m)), in_larger)));
        for_each_set(f, may_pass, [&](std::size_t lane) {
            perhaps.push_back(pixel_of_row + u + static_cast<std::uint32_t>(lane));
        });
    }
    return false;
}

}  // namespace octoskin::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace octoskin {
namespace {

HWY_EXPORT(is_passed);

std::array<float, 3> array_of(const Eigen::Vector3d& p) {
    return {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())};
}

}  // namespace

OpenVoxels::OpenVoxels(const CertainView& view, const PlacedImage& image, const VoxelLattice& lattice,
                       const PictureTest& picture)
    : view_(view),
      image_(image),
      picture_(picture),
      centre_of_origin_(lattice.centre_of(*lattice.key_of(image.origin.cast<double>()))),
      half_depth_m_(static_cast<float>(view.half_depth_m + view.margin_m)) {
    const CameraIntrinsics& camera = view.camera;
    const Eigen::Matrix3d R_map_camera = view.T_camera_map.linear().transpose();
    const Eigen::Vector3d corner((0.5 - camera.cx) / camera.fx, (0.5 - camera.cy) / camera.fy, 1.0);
    first_ = R_map_camera * corner;
    next_u_ = R_map_camera.col(0) / camera.fx;
    next_v_ = R_map_camera.col(1) / camera.fy;
}

bool OpenVoxels::is_passed(const Eigen::Vector3d& centre_map, std::vector<RayPiece>& pieces) {
    const Eigen::Vector3d centre = view_.T_camera_map * centre_map;
    if (picture_.is_out_of_sight(centre, 1)) return false;
    const PixelBox box = picture_.pixels_of(centre, 1).value_or(picture_.all_pixels());
    const auto z = static_cast<float>(centre.z());
    if (picture_.longest(box) < z - half_depth_m_) return false;

    const Eigen::Vector3d p = centre_map - image_.origin.cast<double>();
    const double half_edge_m = 0.5 * view_.resolution_m;
    RowOfRays row{.centre = array_of(p),
                  .first = {},
                  .next = array_of(next_u_),
                  .side = {},
                  .half_smaller = static_cast<float>(half_edge_m - view_.margin_m),
                  .half_larger = static_cast<float>(half_edge_m + view_.margin_m),
                  .margin_m = static_cast<float>(view_.margin_m)};
    for (Eigen::Index i = 0; i < 3; ++i) {
        const double away = centre_map[i] - centre_of_origin_[i];
        row.side[static_cast<std::size_t>(i)] = away > half_edge_m    ? 1.0F
                                                : away < -half_edge_m ? -1.0F
                                                                      : 0.0F;
    }
    perhaps_.clear();
    const double v_middle =
        view_.camera.fy * centre.y() / std::max(centre.z(), half_edge_m) + view_.camera.cy;
    const auto middle = static_cast<std::int64_t>(std::clamp<double>(v_middle, box.v_first, box.v_last));
    // From the middle outwards: rays that pass are found soonest there.
    for (std::int64_t step = 0, v = middle;; ++step) {
        v += step % 2 == 0 ? step : -step;
        const bool is_above = v < box.v_first;
        const bool is_below = v > box.v_last;
        if (!is_above && !is_below) {
            row.first = array_of(first_ + static_cast<double>(v) * next_v_);
            const auto pixel_of_row = static_cast<std::uint32_t>(v) * image_.width;
            if (HWY_DYNAMIC_DISPATCH(is_passed)(row, image_.reach_m.data(), box.u_first, box.u_last,
                                                pixel_of_row, perhaps_)) {
                return true;
            }
        }
        if (step > 2 * (static_cast<std::int64_t>(box.v_last) - box.v_first) + 2) break;
    }
    const float from_m = std::max(z - half_depth_m_, 0.0F);
    for (const std::uint32_t pixel : perhaps_) {
        if (from_m < image_.reach_m[pixel])
            pieces.push_back({pixel, from_m, std::max(z, 0.0F) + half_depth_m_});
    }
    return false;
}

}  // namespace octoskin
#endif
