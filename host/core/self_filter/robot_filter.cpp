#include "host/core/self_filter/robot_filter.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>

#include "host/core/self_filter/axis_distances.hpp"

namespace octoskin {
namespace {

struct PixelRectangle {
    PixelSpan columns;
    PixelSpan rows;
};

struct Interval {
    double low = 0.0;
    double high = 0.0;
};

/// The slopes x / z of the two tangents from the origin to a disc of `radius` about (x, z). Empty if the disc
/// reaches the plane z = 0 or lies behind it: there is no bound then.
std::optional<Interval> tangent_slopes(double x, double z, double radius) {
    const double denominator = z * z - radius * radius;
    if (!(z > radius) || !(denominator > 0.0)) return std::nullopt;
    const double root = radius * std::sqrt(x * x + denominator);
    return Interval{(x * z - root) / denominator, (x * z + root) / denominator};
}

/// The bounds of the discs at both ends. All points between the ends project between their projections.
std::optional<Interval> slopes_of(const PosedCapsule& capsule, double radius_m, Eigen::Index axis) {
    const auto a = tangent_slopes(capsule.p_a[axis], capsule.p_a.z(), radius_m);
    const auto b = tangent_slopes(capsule.p_b[axis], capsule.p_b.z(), radius_m);
    if (!a || !b) return std::nullopt;
    return Interval{std::min(a->low, b->low), std::max(a->high, b->high)};
}

PixelRectangle rectangle_of(const PosedCapsule& capsule, double radius_m, const PixelRays& pixel_rays) {
    // The tangents are exact; a pixel on a tangent must not be lost by rounding.
    constexpr double kSlack = 1e-9;
    const auto x = slopes_of(capsule, radius_m, 0);
    const auto y = slopes_of(capsule, radius_m, 1);
    if (!x || !y) return {{0, pixel_rays.camera().width}, {0, pixel_rays.camera().height}};
    return {pixel_rays.columns(x->low - kSlack, x->high + kSlack),
            pixel_rays.rows(y->low - kSlack, y->high + kSlack)};
}

/// The range of depths of the capsule's points.
Interval depths_of(const PosedCapsule& capsule, double radius_m) {
    const auto [low, high] = std::minmax(capsule.p_a.z(), capsule.p_b.z());
    return {low - radius_m, high + radius_m};
}

/// Copies a row's pixels within the capsule's columns.
void take_row(const PixelRays& pixel_rays, PixelSpan columns, std::uint32_t v, const float* depth_m,
              RowOfPixels& row) {
    std::copy(depth_m + columns.begin, depth_m + columns.end, row.depth_m.begin());
    const auto count = static_cast<std::ptrdiff_t>(columns.end - columns.begin);
    if (pixel_rays.camera().lens.is_none()) {
        // x is the same in all rows; the caller has copied it.
        std::fill(row.y.begin(), row.y.begin() + count, static_cast<float>(pixel_rays.at(0, v).y));
        return;
    }
    for (std::uint32_t u = columns.begin; u < columns.end; ++u) {
        const RaySlope ray = pixel_rays.at(u, v);
        row.x[u - columns.begin] = static_cast<float>(ray.x);
        row.y[u - columns.begin] = static_cast<float>(ray.y);
    }
}

std::size_t remove_capsule(DepthImage& image, const PixelRays& pixel_rays, const PosedCapsule& capsule,
                           double margin_m, RowOfPixels& row) {
    const double radius_m = capsule.radius_m + margin_m;
    const PixelRectangle rectangle = rectangle_of(capsule, radius_m, pixel_rays);
    const std::uint32_t begin = rectangle.columns.begin;
    const std::uint32_t end = rectangle.columns.end;
    if (begin == end) return 0;
    const Interval depths = depths_of(capsule, radius_m);
    const RoughCapsule rough(capsule, radius_m);
    /// Exact test, for pixels that single precision cannot decide.
    const auto is_robot = [&](std::uint32_t u, std::uint32_t v, double z) {
        if (!(z >= depths.low && z <= depths.high)) return false;
        const RaySlope ray = pixel_rays.at(u, v);
        return distance_to_surface(capsule, {ray.x * z, ray.y * z, z}) <= margin_m;
    };
    for (std::uint32_t u = begin; u < end; ++u) row.x[u - begin] = static_cast<float>(pixel_rays.at(u, 0).x);
    std::size_t removed = 0;
    for (std::uint32_t v = rectangle.rows.begin; v < rectangle.rows.end; ++v) {
        float* const pixels = image.depth_m.data() + std::size_t{v} * image.width;
        take_row(pixel_rays, rectangle.columns, v, pixels, row);
        const RowOutcome outcome = remove_certain(rough, end - begin, row);
        if (outcome.removed > 0) {
            std::copy_n(row.depth_m.begin(), end - begin, pixels + begin);
            removed += outcome.removed;
        }
        if (!outcome.is_unsure) continue;
        for (std::uint32_t u = begin; u < end; ++u) {
            const float squared_m2 = row.squared_m2[u - begin];
            const bool is_unsure = squared_m2 > rough.inside_m2 && squared_m2 <= rough.outside_m2;
            if (!is_unsure || !is_robot(u, v, static_cast<double>(pixels[u]))) continue;
            pixels[u] = std::numeric_limits<float>::quiet_NaN();
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

std::size_t remove_robot(DepthImage& image, const PixelRays& pixel_rays,
                         std::span<const PosedCapsule> body_camera, double margin_m) {
    assert(image.width == pixel_rays.camera().width && image.height == pixel_rays.camera().height);
    assert(image.depth_m.size() == std::size_t{image.width} * image.height);
    if (!std::isfinite(margin_m) || !std::all_of(body_camera.begin(), body_camera.end(), is_finite)) {
        return remove_everything(image);
    }
    std::size_t removed = 0;
    RowOfPixels row(image.width);
    for (const PosedCapsule& capsule : body_camera) {
        removed += remove_capsule(image, pixel_rays, capsule, margin_m, row);
    }
    return removed;
}

}  // namespace octoskin
