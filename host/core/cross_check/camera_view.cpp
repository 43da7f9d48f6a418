#include "host/core/cross_check/camera_view.hpp"

#include <algorithm>
#include <cmath>

namespace octoskin {
namespace {

/// Closer to the sensor, the robot's own surroundings are ignored.
constexpr double kWalkBeginM = 0.1;
constexpr double kWalkStepM = 0.03;
/// A surface counts as crossed where the camera's depth and the ray's depth differ by at most this.
constexpr double kCrossingM = 0.12;
/// Step of a walk, as a fraction of the distance to the seen surface.
constexpr double kStepShare = 0.4;
constexpr double kStepMinM = 0.02;
/// A doubtful pixel makes 3 cm around it doubtful (CertainPixels): no step is long enough to skip that.
constexpr double kStepMaxM = 0.08;
constexpr int kSamplesMax = 120;
/// Depth by which an unseen object is assumed to hide what is behind it, used for the step length.
constexpr double kUnknownM = 0.1;
/// A surface is sampled this far before and behind the point where the ray meets it.
constexpr double kBesideM = 0.05;
/// A ray nearly parallel to a surface does not determine where it meets the surface.
constexpr double kDepthPerMMin = 0.25;
/// Angle between the pixels of a plane; `kPlaneSteps` pixels to each side.
constexpr double kPlaneStepRad = 0.006;
constexpr int kPlaneSteps = 2;
/// Largest deviation of the pixels from a plane.
constexpr double kPlaneSigmaMaxM = 0.1;

}  // namespace

CameraView::CameraView(const CrossCheckImages& images, const CameraIntrinsics& camera,
                       const Eigen::Isometry3d& T_map_camera, double ray_slope_max)
    : everything_(images.everything),
      world_(images.world),
      certainty_(images.certainty),
      camera_(camera),
      T_camera_map_(T_map_camera.inverse()),
      ray_slope_max_(ray_slope_max) {}

/// The pixel that shows the point, row-major.
std::optional<std::size_t> CameraView::pixel_at(const Eigen::Vector3d& p_camera) const {
    if (!(p_camera.z() > 0.0)) return std::nullopt;
    const RaySlope ray{p_camera.x() / p_camera.z(), p_camera.y() / p_camera.z()};
    if (!(ray.x * ray.x + ray.y * ray.y <= ray_slope_max_ * ray_slope_max_)) return std::nullopt;
    const RaySlope picture = distorted(camera_.lens, ray);
    const double u = picture.x * camera_.fx + camera_.cx;
    const double v = picture.y * camera_.fy + camera_.cy;
    if (!(u >= 0.0 && u < camera_.width && v >= 0.0 && v < camera_.height)) return std::nullopt;
    return static_cast<std::size_t>(v) * camera_.width + static_cast<std::size_t>(u);
}

std::optional<Look> CameraView::look_at_camera(const Eigen::Vector3d& p_camera) const {
    const auto pixel = pixel_at(p_camera);
    if (!pixel) return std::nullopt;
    const Certainty certainty = certainty_[*pixel];
    const auto world_m = static_cast<double>(world_.depth_m[*pixel]);
    if (std::isfinite(world_m)) return Look{world_m - p_camera.z(), false, certainty};
    const auto depth_m = static_cast<double>(everything_.depth_m[*pixel]);
    if (!std::isfinite(depth_m)) return std::nullopt;
    return Look{depth_m - p_camera.z(), true, certainty};
}

std::optional<Look> CameraView::look_at(const Eigen::Vector3d& p_map) const {
    return look_at_camera(T_camera_map_ * p_map);
}

/// The inverse depth of a plane is linear in the image.
std::optional<SeenPlane> CameraView::plane_at(const Eigen::Vector3d& p_camera) const {
    const auto pixel = pixel_at(p_camera);
    if (!pixel || certainty_[*pixel] == Certainty::none) return std::nullopt;
    const int step = std::max(1, static_cast<int>(std::lround(kPlaneStepRad * camera_.fx)));
    const auto u = static_cast<int>(*pixel % camera_.width);
    const auto v = static_cast<int>(*pixel / camera_.width);
    const int reach = kPlaneSteps * step;
    if (u < reach || v < reach || u + reach >= static_cast<int>(camera_.width) ||
        v + reach >= static_cast<int>(camera_.height))
        return std::nullopt;
    double sum = 0.0;
    double sum_u = 0.0;
    double sum_v = 0.0;
    double squares = 0.0;
    for (int j = -kPlaneSteps; j <= kPlaneSteps; ++j) {
        for (int i = -kPlaneSteps; i <= kPlaneSteps; ++i) {
            const auto row = static_cast<std::size_t>(v + j * step);
            const auto column = static_cast<std::size_t>(u + i * step);
            const double inverse = 1.0 / static_cast<double>(world_.depth_m[row * camera_.width + column]);
            sum += inverse;
            sum_u += i * inverse;
            sum_v += j * inverse;
            squares += inverse * inverse;
        }
    }
    if (!std::isfinite(sum)) return std::nullopt;
    constexpr double kCount = 25.0;
    constexpr double kSquaresOfSteps = 50.0;  // sum of i^2, and of j^2, over all pixels
    const double middle = sum / kCount;
    const double per_u = sum_u / kSquaresOfSteps;
    const double per_v = sum_v / kSquaresOfSteps;
    const double rest =
        squares - kCount * middle * middle - kSquaresOfSteps * (per_u * per_u + per_v * per_v);
    if (std::sqrt(std::max(0.0, rest) / (kCount - 3.0)) > kPlaneSigmaMaxM * middle * middle)
        return std::nullopt;
    const double x = p_camera.x() / p_camera.z();
    const double y = p_camera.y() / p_camera.z();
    const double per_x = per_u / step * camera_.fx;
    const double per_y = per_v / step * camera_.fy;
    const Eigen::Vector3d plane(per_x, per_y, middle - per_x * x - per_y * y);  // plane.p = 1
    return SeenPlane{.normal = -plane.normalized(), .distance_m = 1.0 / plane.norm()};
}

bool CameraView::is_stopped(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double range_m,
                            double bound_m) const {
    std::optional<double> before;
    bool has_crossed = false;
    for (double along_m = kWalkBeginM; along_m <= range_m; along_m += kWalkStepM) {
        const auto look = look_at(origin + along_m * direction);
        const auto now =
            look && look->is_certain() && !look->is_robot ? std::optional(look->behind_m) : std::nullopt;
        const bool is_continuous = before && now && std::abs(*now - *before) <= kCrossingM;
        if (!is_continuous || *now >= 0.0) {
            has_crossed = false;
        } else if (*before >= 0.0) {
            has_crossed = true;
        }
        if (has_crossed && *now < -bound_m) return true;
        before = now;
    }
    return false;
}

/// `crossed_m`: along a ray in camera coordinates. Returns where the ray crosses the surface, and its change
/// of depth per metre; negative: from behind.
std::optional<CameraView::Crossing> CameraView::crossing_at(const Eigen::Vector3d& p,
                                                            const Eigen::Vector3d& d,
                                                            double crossed_m) const {
    double sum = 0.0;
    double ends[2] = {};
    for (int i = -1; i <= 1; ++i) {
        const auto seen = look_at_camera(p + (crossed_m + i * kBesideM) * d);
        if (!seen || seen->is_robot || (i == 0 && !seen->is_certain())) return std::nullopt;
        sum += seen->behind_m;
        if (i != 0) ends[(i + 1) / 2] = seen->behind_m;
    }
    const double depth_per_m = (ends[0] - ends[1]) / (2.0 * kBesideM);
    if (!(std::abs(depth_per_m) >= kDepthPerMMin && std::abs(depth_per_m) <= kCrossingM / kBesideM))
        return std::nullopt;
    return Crossing{crossed_m + sum / (3.0 * depth_per_m), depth_per_m};
}

RayReach CameraView::reach(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                           double range_max_m) const {
    const Eigen::Vector3d p = T_camera_map_ * origin;
    const Eigen::Vector3d d = T_camera_map_.linear() * direction;
    RayReach reach;
    struct Before {
        double along_m;
        double behind_m;
        bool is_robot;
    };
    std::optional<Before> before;
    double along_m = kWalkBeginM;
    for (int i = 0; i < kSamplesMax && along_m <= range_max_m; ++i) {
        // A pixel without a value is treated like the robot: it hides the ray.
        const Look seen = look_at_camera(p + along_m * d).value_or(Look{-kUnknownM, true, Certainty::none});
        const bool is_hidden = seen.behind_m < 0.0;
        const bool was_hidden = before && before->behind_m < 0.0;
        if (before && is_hidden != was_hidden) {
            const double step_m = along_m - before->along_m;
            const double jump_m = std::abs(before->behind_m - seen.behind_m);
            const bool is_world = !before->is_robot && !seen.is_robot;
            if (jump_m > kCrossingM && step_m > 1.01 * kStepMinM) {
                along_m = before->along_m + std::max(kStepMinM, 0.25 * step_m);
                continue;
            }
            if (is_world && jump_m <= kCrossingM) {
                const auto crossing =
                    crossing_at(p, d, before->along_m + step_m * std::abs(before->behind_m) / jump_m);
                if (!crossing || (crossing->depth_per_m < 0.0) != was_hidden) return reach;
                reach.surface_m = crossing->along_m;
                reach.depth_per_m = std::abs(crossing->depth_per_m);
                reach.is_from_behind = was_hidden;
                (was_hidden ? reach.hidden_until_m : reach.clear_m) = crossing->along_m;
                return reach;
            }
            // Otherwise, the ray passes an outline.
        }
        if (is_hidden || was_hidden || !seen.is_clear()) reach.hidden_until_m = along_m;
        if (!is_hidden && seen.is_clear()) reach.clear_m = along_m;
        before = Before{along_m, seen.behind_m, seen.is_robot};
        along_m += std::clamp(kStepShare * std::abs(seen.behind_m), kStepMinM, kStepMaxM);
    }
    return reach;
}

}  // namespace octoskin
