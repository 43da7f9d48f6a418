#include "host/core/self_filter/robot_filter.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>

namespace octoskin {
namespace {

/// Pixels [u_begin, u_end) x [v_begin, v_end).
struct PixelRectangle {
    std::uint32_t u_begin = 0;
    std::uint32_t u_end = 0;
    std::uint32_t v_begin = 0;
    std::uint32_t v_end = 0;
};

struct Interval {
    double low = 0.0;
    double high = 0.0;
};

/// The slopes x / z under which a disc of `radius` about (x, z) is seen from the origin: its two tangents.
/// Empty if the disc reaches to the plane z = 0 or behind it, where there is no bound.
std::optional<Interval> tangent_slopes(double x, double z, double radius) {
    const double denominator = z * z - radius * radius;
    if (!(z > radius) || !(denominator > 0.0)) return std::nullopt;
    const double root = radius * std::sqrt(x * x + denominator);
    return Interval{(x * z - root) / denominator, (x * z + root) / denominator};
}

/// The bounds of both ends' discs: what lies between the ends projects between their projections.
std::optional<Interval> slopes_of(const PosedCapsule& capsule, double radius_m, Eigen::Index axis) {
    const auto a = tangent_slopes(capsule.p_a[axis], capsule.p_a.z(), radius_m);
    const auto b = tangent_slopes(capsule.p_b[axis], capsule.p_b.z(), radius_m);
    if (!a || !b) return std::nullopt;
    return Interval{std::min(a->low, b->low), std::max(a->high, b->high)};
}

/// Index of the pixel whose square holds this image coordinate, moved to the nearest one in [0, size].
std::uint32_t clamp_pixel(double coordinate, std::uint32_t size) {
    return static_cast<std::uint32_t>(std::clamp(std::floor(coordinate), 0.0, static_cast<double>(size)));
}

PixelRectangle rectangle_of(const PosedCapsule& capsule, double radius_m, const CameraIntrinsics& camera) {
    PixelRectangle rectangle{.u_begin = 0, .u_end = camera.width, .v_begin = 0, .v_end = camera.height};
    const auto x = slopes_of(capsule, radius_m, 0);
    const auto y = slopes_of(capsule, radius_m, 1);
    if (!x || !y) return rectangle;
    rectangle.u_begin = clamp_pixel(x->low * camera.fx + camera.cx, camera.width);
    rectangle.u_end = clamp_pixel(x->high * camera.fx + camera.cx + 1.0, camera.width);
    rectangle.v_begin = clamp_pixel(y->low * camera.fy + camera.cy, camera.height);
    rectangle.v_end = clamp_pixel(y->high * camera.fy + camera.cy + 1.0, camera.height);
    return rectangle;
}

/// Depths that points of the capsule can have.
Interval depths_of(const PosedCapsule& capsule, double radius_m) {
    const auto [low, high] = std::minmax(capsule.p_a.z(), capsule.p_b.z());
    return {low - radius_m, high + radius_m};
}

std::size_t remove_capsule(DepthImage& image, const CameraIntrinsics& camera, const PosedCapsule& capsule,
                           double margin_m) {
    const double radius_m = capsule.radius_m + margin_m;
    const PixelRectangle rectangle = rectangle_of(capsule, radius_m, camera);
    const Interval depths = depths_of(capsule, radius_m);
    std::size_t removed = 0;
    for (std::uint32_t v = rectangle.v_begin; v < rectangle.v_end; ++v) {
        for (std::uint32_t u = rectangle.u_begin; u < rectangle.u_end; ++u) {
            float& pixel = image.depth_m[std::size_t{v} * image.width + u];
            const auto z = static_cast<double>(pixel);
            if (!(z >= depths.low && z <= depths.high))
                continue;  // no value, or before or behind the capsule
            const Eigen::Vector3d p_camera((u + 0.5 - camera.cx) / camera.fx * z,
                                           (v + 0.5 - camera.cy) / camera.fy * z, z);
            if (!(distance_to_surface(capsule, p_camera) <= margin_m)) continue;
            pixel = std::numeric_limits<float>::quiet_NaN();
            ++removed;
        }
    }
    return removed;
}

bool is_finite(const PosedCapsule& capsule) {
    return capsule.p_a.allFinite() && capsule.p_b.allFinite() && std::isfinite(capsule.radius_m);
}

std::size_t remove_everything(DepthImage& image) {
    const auto is_value = [](float depth_m) { return !std::isnan(depth_m); };
    const auto removed = std::count_if(image.depth_m.begin(), image.depth_m.end(), is_value);
    std::fill(image.depth_m.begin(), image.depth_m.end(), std::numeric_limits<float>::quiet_NaN());
    return static_cast<std::size_t>(removed);
}

}  // namespace

std::size_t remove_robot(DepthImage& image, const CameraIntrinsics& camera,
                         std::span<const PosedCapsule> body_camera, double margin_m) {
    assert(image.width == camera.width && image.height == camera.height);
    assert(image.depth_m.size() == std::size_t{image.width} * image.height);
    if (!std::isfinite(margin_m) || !std::all_of(body_camera.begin(), body_camera.end(), is_finite)) {
        return remove_everything(image);
    }
    std::size_t removed = 0;
    for (const PosedCapsule& capsule : body_camera) {
        removed += remove_capsule(image, camera, capsule, margin_m);
    }
    return removed;
}

}  // namespace octoskin
