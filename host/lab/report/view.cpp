#include "host/lab/report/view.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace octoskin::report {
namespace {

constexpr double kMargin = 1.04;
// For a single point: it is in the picture from any distance.
constexpr double kDistanceMinM = 0.1;

/// Direction from the middle to the eye, as a unit vector.
struct Bearing {
    double azimuth_rad;
    double elevation_rad;
    [[nodiscard]] Eigen::Vector3d unit() const {
        return {std::cos(elevation_rad) * std::cos(azimuth_rad),
                std::cos(elevation_rad) * std::sin(azimuth_rad), std::sin(elevation_rad)};
    }
};
constexpr Bearing kFront = {.azimuth_rad = -2.90, .elevation_rad = 0.50};
constexpr Bearing kBack = {.azimuth_rad = 0.48, .elevation_rad = 0.46};

/// Half the picture's size at a distance of 1 m.
Eigen::Vector2d half_size_of(const View& view) {
    const double tan_v = std::tan(view.vertical_fov_rad / 2.0);
    return {tan_v * view.size.width / view.size.height, tan_v};
}

/// How far from the target the eye must be for all points to be in the picture.
double distance_for(std::span<const Eigen::Vector3d> points, const View& view, const Eigen::Matrix3d& axes) {
    const Eigen::Vector2d half_size = half_size_of(view);
    double distance_m = kDistanceMinM;
    for (const auto& point : points) {
        const Eigen::Vector3d p_view = axes.transpose() * (point - view.target);
        const double needed = (p_view.head<2>().cwiseAbs().cwiseQuotient(half_size)).maxCoeff();
        distance_m = std::max(distance_m, kMargin * needed - p_view.z());
    }
    return distance_m;
}

/// Aims at the middle of the projected points and adjusts the distance; converges in a few iterations.
View framed(std::span<const Eigen::Vector3d> points, PictureSize size, const Bearing& bearing) {
    Eigen::Matrix3d axes;  // right, down, forward
    axes.col(2) = -bearing.unit();
    axes.col(0) = axes.col(2).cross(Eigen::Vector3d::UnitZ()).normalized();
    axes.col(1) = axes.col(2).cross(axes.col(0));
    View view;
    view.size = size;
    view.target = points.front();
    constexpr int kRounds = 12;
    for (int round = 0; round < kRounds; ++round) {
        const double distance_m = distance_for(points, view, axes);
        Eigen::AlignedBox2d shown;
        for (const auto& point : points) {
            const Eigen::Vector3d p_view = axes.transpose() * (point - view.target);
            shown.extend(Eigen::Vector2d(p_view.head<2>() / (distance_m + p_view.z())));
        }
        view.target += distance_m * (axes.leftCols<2>() * shown.center());
    }
    view.eye = view.target - distance_for(points, view, axes) * axes.col(2);
    return view;
}

}  // namespace

ViewPair views_of(std::span<const Eigen::Vector3d> points, PictureSize size) {
    assert(!points.empty());
    return {framed(points, size, kFront), framed(points, size, kBack)};
}

bool shows(const View& view, const Eigen::Vector3d& point) {
    const Eigen::Vector3d forward = (view.target - view.eye).normalized();
    const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
    const Eigen::Vector3d offset = point - view.eye;
    const double ahead = offset.dot(forward);
    const Eigen::Vector2d half_size = ahead * half_size_of(view);
    return ahead > 0.0 && std::abs(offset.dot(right)) < half_size.x() &&
           std::abs(offset.dot(forward.cross(right))) < half_size.y();
}

std::vector<Eigen::Vector3d> corners_of(const Eigen::AlignedBox3d& box) {
    std::vector<Eigen::Vector3d> corners;
    for (unsigned i = 0; i < 8; ++i) {
        corners.push_back(box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i)));
    }
    return corners;
}

ViewRays::ViewRays(const View& view)
    : forward_((view.target - view.eye).normalized()),
      right_(forward_.cross(Eigen::Vector3d::UnitZ()).normalized()),
      down_(forward_.cross(right_)),
      pixel_size_(2.0 * std::tan(view.vertical_fov_rad / 2.0) / view.size.height),
      half_width_(view.size.width / 2.0),
      half_height_(view.size.height / 2.0) {}

Eigen::Vector3f ViewRays::direction(double column, double row) const {
    const Eigen::Vector3d through =
        forward_ + pixel_size_ * ((column - half_width_) * right_ + (row - half_height_) * down_);
    return through.normalized().cast<float>();
}

Eigen::Vector3f ViewRays::sun() const {
    const Eigen::Vector3d level = Eigen::Vector3d(forward_.x(), forward_.y(), 0.0).normalized();
    return (-0.62 * level - 0.55 * right_ + Eigen::Vector3d(0.0, 0.0, 1.0)).normalized().cast<float>();
}

}  // namespace octoskin::report
