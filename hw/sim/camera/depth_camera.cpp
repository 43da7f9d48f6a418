#include "hw/sim/camera/depth_camera.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <optional>

namespace octoskin::sim {
namespace {

/// Tangents of the angles to the edges of a disc, in one plane through the optical axis.
struct Span {
    double low;
    double high;
};

/// `across`, `depth`: the disc's centre. Empty if a part of it may be beside or behind the camera.
std::optional<Span> span_of(double across, double depth, double radius) {
    const double distance = std::hypot(across, depth);
    if (distance <= radius) {
        return std::nullopt;
    }
    const double middle = std::atan2(across, depth);
    const double half = std::asin(radius / distance);
    constexpr double kWidest = 0.499 * std::numbers::pi;
    if (std::abs(middle) + half >= kWidest) {
        return std::nullopt;
    }
    return Span{std::tan(middle - half), std::tan(middle + half)};
}

/// The pixels whose centres may lie within the span, [begin, end).
std::pair<std::uint32_t, std::uint32_t> pixels_of(Span span, double focal_px, double centre_px,
                                                  std::uint32_t size) {
    const auto clamped = [&](double pixel) {
        return static_cast<std::uint32_t>(std::clamp(pixel, 0.0, static_cast<double>(size)));
    };
    return {clamped(std::floor(span.low * focal_px + centre_px - 0.5)),
            clamped(std::ceil(span.high * focal_px + centre_px - 0.5) + 1.0)};
}

std::vector<RaySlope> rays_of(const rig::Camera& camera) {
    std::vector<RaySlope> rays;
    rays.reserve(std::size_t{camera.width} * camera.height);
    for_each_pixel_ray(camera,
                       [&](std::uint32_t, std::uint32_t, const RaySlope& ray) { rays.push_back(ray); });
    return rays;
}

}  // namespace

DepthCamera::DepthCamera(const World& world, const rig::Camera& camera, const DepthNoise& noise,
                         std::uint64_t seed)
    : camera_(camera), noise_(noise), seed_(seed) {
    assert(camera.depth_max_m <= rig::kDepthLargest_m);  // checked where the rig was read
    if (!camera.lens.is_none()) {
        rays_ = rays_of(camera);
    }
    std::vector<Eigen::Vector3d> directions_base;
    directions_base.reserve(std::size_t{camera.width} * camera.height);
    for (std::uint32_t v = 0; v < camera.height; ++v) {
        for (std::uint32_t u = 0; u < camera.width; ++u) {
            directions_base.emplace_back(camera.T_link_camera.linear() * direction_camera(u, v));
        }
    }
    background_m_.resize(directions_base.size());
    // Noise may bring a surface back into the depth limits: cast well beyond them.
    world.cast_fan(camera.T_link_camera.translation(), directions_base,
                   camera.depth_max_m + noise_margin_m(noise, camera.depth_max_m), background_m_);
}

Eigen::Vector3d DepthCamera::direction_camera(std::uint32_t u, std::uint32_t v) const {
    const RaySlope ray =
        rays_.empty() ? picture_of(camera_, u, v) : rays_[std::size_t{v} * camera_.width + u];
    return {ray.x, ray.y, 1.0};
}

DepthCamera::Rectangle DepthCamera::bounds_of(const BodyCapsule& capsule) const {
    const Rectangle everything{0, camera_.width, 0, camera_.height};
    if (!rays_.empty()) {
        return everything;  // a lens distorts the hull, too
    }
    Rectangle bounds{camera_.width, 0, camera_.height, 0};
    // A capsule is the convex hull of its two end spheres, so the hull of their projections contains its
    // projection.
    for (const Eigen::Vector3d* end : {&capsule.p_base_a, &capsule.p_base_b}) {
        const auto across = span_of(end->x(), end->z(), capsule.radius_m);
        const auto down = span_of(end->y(), end->z(), capsule.radius_m);
        if (!across || !down) {
            return everything;
        }
        const auto [u_begin, u_end] = pixels_of(*across, camera_.fx, camera_.cx, camera_.width);
        const auto [v_begin, v_end] = pixels_of(*down, camera_.fy, camera_.cy, camera_.height);
        bounds = {std::min(bounds.u_begin, u_begin), std::max(bounds.u_end, u_end),
                  std::min(bounds.v_begin, v_begin), std::max(bounds.v_end, v_end)};
    }
    return bounds;
}

void DepthCamera::draw(const BodyCapsule& capsule, std::vector<double>& depth_m) const {
    const Rectangle bounds = bounds_of(capsule);
    for (std::uint32_t v = bounds.v_begin; v < bounds.v_end; ++v) {
        for (std::uint32_t u = bounds.u_begin; u < bounds.u_end; ++u) {
            double& nearest = depth_m[std::size_t{v} * camera_.width + u];
            const auto t = cast_capsule(capsule, Eigen::Vector3d::Zero(), direction_camera(u, v));
            if (t && *t < nearest) {
                nearest = *t;
            }
        }
    }
}

void DepthCamera::draw(const PosedMesh& mesh, std::vector<double>& depth_m) const {
    const Rectangle bounds = bounds_of({mesh.p_middle(), mesh.p_middle(), mesh.mesh->radius_m()});
    if (bounds.u_begin >= bounds.u_end) return;
    std::vector<Eigen::Vector3d> directions;
    std::vector<TriangleHit> hits(bounds.u_end - bounds.u_begin);
    for (std::uint32_t v = bounds.v_begin; v < bounds.v_end; ++v) {
        directions.clear();
        for (std::uint32_t u = bounds.u_begin; u < bounds.u_end; ++u)
            directions.push_back(direction_camera(u, v));
        mesh.cast_fan(Eigen::Vector3d::Zero(), directions, rig::kDepthLargest_m, hits);
        for (std::size_t i = 0; i < hits.size(); ++i) {
            double& nearest = depth_m[std::size_t{v} * camera_.width + bounds.u_begin + i];
            nearest = std::min(nearest, hits[i].t);
        }
    }
}

std::vector<std::uint16_t> DepthCamera::render(const PosedBody& body, std::uint32_t frame_index) const {
    std::vector<double> depth_m = background_m_;
    const Eigen::Isometry3d T_camera_base = camera_.T_link_camera.inverse();
    for (const BodyCapsule& capsule : body.capsules) {
        draw({T_camera_base * capsule.p_base_a, T_camera_base * capsule.p_base_b, capsule.radius_m}, depth_m);
    }
    for (const PosedMesh& mesh : body.meshes) draw({mesh.mesh, T_camera_base * mesh.T_frame_link}, depth_m);
    return measured_mm(noise_, {camera_.width, camera_.height, depth_m},
                       {camera_.depth_min_m, camera_.depth_max_m}, seed_, frame_index);
}

}  // namespace octoskin::sim
