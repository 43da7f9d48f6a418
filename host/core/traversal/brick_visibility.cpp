#include "host/core/traversal/brick_visibility.hpp"

#include <algorithm>
#include <cmath>

namespace octoskin {
namespace {

constexpr double kRounding_px = 0.01;

}  // namespace

BrickVisibility::BrickVisibility(const CertainView& view, const RangePyramid& reach)
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

bool BrickVisibility::is_out_of_sight(const Eigen::Vector3d& centre, int voxels) const {
    if (centre.z() + voxels * view_.half_depth_m + view_.margin_m < 0.0) return true;
    for (std::size_t i = 0; i < sides_.size(); ++i) {
        if (centre.dot(sides_[i]) < -voxels * half_edge_[i]) return true;
    }
    return false;
}

std::optional<PixelBox> BrickVisibility::pixels_of(const Eigen::Vector3d& centre, int voxels) const {
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

double BrickVisibility::corner_m(Eigen::Index axis, double slope) const {
    const double half_m = 0.5 * view_.resolution_m + view_.margin_m;
    const auto R = view_.T_camera_map.linear();
    return half_m * (std::abs(R(axis, 0) - slope * R(2, 0)) + std::abs(R(axis, 1) - slope * R(2, 1)) +
                     std::abs(R(axis, 2) - slope * R(2, 2)));
}

SquareOfPixels BrickVisibility::square_of_voxels(const Eigen::Vector3d& centre, int voxels) const {
    const double half_depth_m = voxels * view_.half_depth_m + view_.margin_m;
    const double nearest_m = centre.z() - half_depth_m;
    if (nearest_m < half_depth_m) return {};
    const double other_slopes = voxels * view_.radius_m / nearest_m;
    const auto apart = [&](Eigen::Index axis, double focal) {
        const double slope = centre[axis] / centre.z();
        // For slopes between two values the corners are no further apart than at one of the two.
        return focal * std::max(corner_m(axis, slope - other_slopes), corner_m(axis, slope + other_slopes)) /
               nearest_m;
    };
    return reach_.square(
        static_cast<float>(std::max(apart(0, camera_.fx), apart(1, camera_.fy)) + kRounding_px));
}

CubeCoverage BrickVisibility::of_cube(const Eigen::Vector3d& centre, int voxels) const {
    const double half_depth_m = voxels * view_.half_depth_m + view_.margin_m;
    const double nearest_m = centre.z() - half_depth_m;
    const double furthest_m = centre.z() + half_depth_m;
    if (is_out_of_sight(centre, voxels)) return CubeCoverage::none;
    const auto box = pixels_of(centre, voxels);
    if (!box) return CubeCoverage::some;
    const auto span = reach_.of(*box);
    if (static_cast<double>(span.longest) < nearest_m) return CubeCoverage::none;
    const bool is_whole = box->u_first > 0 && box->u_last + 1 < camera_.width && box->v_first > 0 &&
                          box->v_last + 1 < camera_.height;
    const bool is_passed = static_cast<double>(span.shortest) > furthest_m;
    return is_whole && is_passed && furthest_m < view_.depth_max_m ? CubeCoverage::all : CubeCoverage::some;
}

}  // namespace octoskin
