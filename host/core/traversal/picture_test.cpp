#include "host/core/traversal/picture_test.hpp"

#include <algorithm>
#include <cmath>

namespace octoskin {

PictureTest::PictureTest(const CertainView& view, const ReachWindows& reach)
    : view_(view), camera_(view.camera), reach_(reach) {
    const double left = camera_.cx / camera_.fx;
    const double right = (camera_.width - camera_.cx) / camera_.fx;
    const double top = camera_.cy / camera_.fy;
    const double bottom = (camera_.height - camera_.cy) / camera_.fy;
    sides_ = {Eigen::Vector3d(1.0, 0.0, left), Eigen::Vector3d(-1.0, 0.0, right),
              Eigen::Vector3d(0.0, 1.0, top), Eigen::Vector3d(0.0, -1.0, bottom)};
    for (std::size_t i = 0; i < sides_.size(); ++i) {
        const Eigen::Vector3d normal_map = view.T_camera_map.linear().transpose() * sides_[i];
        half_edge_[i] = 0.5 * view.resolution_m * normal_map.lpNorm<1>() + view.margin_m;
    }
}

bool PictureTest::is_out_of_sight(const Eigen::Vector3d& centre, int voxels) const {
    if (centre.z() + voxels * view_.half_depth_m + view_.margin_m < 0.0) return true;
    for (std::size_t i = 0; i < sides_.size(); ++i) {
        if (centre.dot(sides_[i]) < -voxels * half_edge_[i]) return true;
    }
    return false;
}

std::optional<PixelBox> PictureTest::pixels_of(const Eigen::Vector3d& centre, int voxels) const {
    const double radius_m = voxels * view_.radius_m;
    const double nearest_m = centre.z() - radius_m;
    if (nearest_m < 0.5 * radius_m) return std::nullopt;
    const double u = camera_.fx * centre.x() / centre.z() + camera_.cx;
    const double v = camera_.fy * centre.y() / centre.z() + camera_.cy;
    const double x = centre.x() / centre.z();
    const double y = centre.y() / centre.z();
    const double u_apart = camera_.fx * radius_m * std::sqrt(1.0 + x * x) / nearest_m + 1.0;
    const double v_apart = camera_.fy * radius_m * std::sqrt(1.0 + y * y) / nearest_m + 1.0;
    const auto pixel = [](double value, std::uint32_t size) {
        return static_cast<std::uint32_t>(std::clamp(value, 0.0, size - 1.0));
    };
    return PixelBox{pixel(u - u_apart, camera_.width), pixel(u + u_apart, camera_.width),
                    pixel(v - v_apart, camera_.height), pixel(v + v_apart, camera_.height)};
}

CubeVerdict PictureTest::of_cube(const Eigen::Vector3d& centre, int voxels) const {
    const double half_depth_m = voxels * view_.half_depth_m + view_.margin_m;
    const double nearest_m = centre.z() - half_depth_m;
    const double furthest_m = centre.z() + half_depth_m;
    if (is_out_of_sight(centre, voxels)) return CubeVerdict::none;
    const auto box = pixels_of(centre, voxels);
    if (!box) return CubeVerdict::some;
    const auto span = reach_.of(*box);
    if (static_cast<double>(span.longest) < nearest_m) return CubeVerdict::none;
    const bool is_whole = box->u_first > 0 && box->u_last + 1 < camera_.width && box->v_first > 0 &&
                          box->v_last + 1 < camera_.height;
    const bool is_passed = static_cast<double>(span.shortest) > furthest_m;
    return is_whole && is_passed && furthest_m < view_.depth_max_m ? CubeVerdict::all : CubeVerdict::some;
}

}  // namespace octoskin
