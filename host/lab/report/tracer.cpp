#include "host/lab/report/tracer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <thread>

#include "host/lab/report/ray_scene.hpp"

namespace octoskin::report {
namespace {

/// Range of the ambient occlusion: an obstacle nearer than this blocks light, less the further away it is.
constexpr float kOcclusionRange_m = 0.7F;
constexpr float kSkyLight = 0.70F;
constexpr float kSunLight = 0.55F;
/// A ray leaves a surface this far from it: more than the rounding error, and not visible.
constexpr float kStart_m = 5e-4F;

/// Directions round +z, distributed as the cosine: the i-th of `count`, all turned by `turn` (0..1).
Eigen::Vector3f hemisphere_direction(int i, int count, float turn) {
    constexpr float kGoldenRatio = std::numbers::phi_v<float>;
    const float azimuth = 2.0F * std::numbers::pi_v<float> * (static_cast<float>(i) / kGoldenRatio + turn);
    const float sine_squared = (static_cast<float>(i) + 0.5F) / static_cast<float>(count);
    const float sine = std::sqrt(sine_squared);
    return {sine * std::cos(azimuth), sine * std::sin(azimuth), std::sqrt(1.0F - sine_squared)};
}

/// 0 (enclosed) to 1 (open), by `count` rays from a point of a surface.
float openness(const RayScene& scene, const Eigen::Vector3f& point, const Eigen::Vector3f& normal, int count,
               float turn) {
    const Eigen::Vector3f across =
        normal.cross(std::abs(normal.z()) < 0.9F ? Eigen::Vector3f::UnitZ() : Eigen::Vector3f::UnitX())
            .normalized();
    const Eigen::Vector3f along = normal.cross(across);
    float sum = 0.0F;
    for (int i = 0; i < count; ++i) {
        const Eigen::Vector3f local = hemisphere_direction(i, count, turn);
        const Eigen::Vector3f direction = local.x() * across + local.y() * along + local.z() * normal;
        const auto blocked = scene.obstacle(point + kStart_m * normal, direction, kOcclusionRange_m);
        sum += blocked ? *blocked / kOcclusionRange_m : 1.0F;
    }
    return sum / static_cast<float>(count);
}

/// A number in 0..1 that differs from one pixel and sample to the next without a visible pattern.
float scatter(std::uint32_t column, std::uint32_t row, std::uint32_t sample) {
    std::uint32_t hash = column * 0x9E3779B1U ^ row * 0x85EBCA77U ^ sample * 0xC2B2AE3DU;
    hash ^= hash >> 15U;
    hash *= 0x2C1B3C6DU;
    hash ^= hash >> 13U;
    return static_cast<float>(hash & 0xFFFFU) / 65536.0F;
}

/// Openness at the quarter points of a face: (u, v) = (1/4, 1/4), (3/4, 1/4), (1/4, 3/4), (3/4, 3/4).
using FaceOpenness = std::array<float, 4>;

FaceOpenness bake(const RayScene& scene, const Face& face) {
    constexpr int kRays = 24;
    const auto& [a, b, c, d] = face.corners;
    const Eigen::Vector3f normal = (b - a).cross(d - a).normalized();
    FaceOpenness baked{};
    for (std::size_t i = 0; i < 4; ++i) {
        const float u = (i & 1U) != 0 ? 0.75F : 0.25F;
        const float v = (i & 2U) != 0 ? 0.75F : 0.25F;
        baked[i] = openness(scene, a + u * (b - a) + v * (d - a), normal, kRays, 0.0F);
    }
    return baked;
}

/// Bilinear, extrapolated to the face's edges.
float at(const FaceOpenness& baked, float u, float v) {
    const float s = 2.0F * u - 0.5F;
    const float t = 2.0F * v - 0.5F;
    const float low = baked[0] + s * (baked[1] - baked[0]);
    const float high = baked[2] + s * (baked[3] - baked[2]);
    return std::clamp(low + t * (high - low), 0.0F, 1.0F);
}

struct Sample {
    Colour light;
    float opacity = 0.0F;
};

struct PixelPlace {
    std::uint32_t column;
    std::uint32_t row;
    std::uint32_t sample;  ///< 0..3
};

}  // namespace

struct Tracer::Impl {
    explicit Impl(Geometry geometry_in) : geometry(std::move(geometry_in)), scene(geometry) {
        for (const auto& face : geometry.faces) {
            face_openness.push_back(bake(scene, face));
        }
    }

    [[nodiscard]] Sample sample(const ViewRays& rays, const Eigen::Vector3f& eye, PixelPlace place) const;
    [[nodiscard]] Colour albedo(const SceneHit& hit, float pixel_m) const;
    void render_rows(const View& view, std::uint32_t first, std::uint32_t step, Image& image) const;

    Geometry geometry;
    RayScene scene;
    std::vector<FaceOpenness> face_openness;
};

/// The colour of the hit geometry; near a face's edge, within half a pixel or a fiftieth of the face, darker.
Colour Tracer::Impl::albedo(const SceneHit& hit, float pixel_m) const {
    switch (hit.shape) {
        case Shape::triangle:
            return geometry.triangles[hit.index].colour;
        case Shape::body:
            return geometry.bodies[hit.index].colour;
        case Shape::line:
            return geometry.lines[hit.index].colour;
        case Shape::face:
            break;
    }
    const Face& face = geometry.faces[hit.index];
    const float edge_m = (face.corners[1] - face.corners[0]).norm();
    const float from_edge_m = edge_m * std::min(std::min(hit.u, 1.0F - hit.u), std::min(hit.v, 1.0F - hit.v));
    const bool is_edge = from_edge_m < std::max(0.5F * pixel_m, 0.02F * edge_m);
    return (is_edge ? 0.55F : 1.0F) * face.colour;
}

Sample Tracer::Impl::sample(const ViewRays& rays, const Eigen::Vector3f& eye, PixelPlace place) const {
    const double column = place.column + ((place.sample & 1U) != 0 ? 0.75 : 0.25);
    const double row = place.row + ((place.sample & 2U) != 0 ? 0.75 : 0.25);
    const Eigen::Vector3f direction = rays.direction(column, row);
    const auto hit = scene.first_hit(eye, direction);
    if (!hit) {
        return {};
    }
    const Colour paint = albedo(*hit, hit->range_m * static_cast<float>(rays.pixel_size()));
    if (hit->shape == Shape::line) {
        return {paint, 1.0F};
    }
    const Eigen::Vector3f point = eye + hit->range_m * direction;
    if (hit->shape == Shape::triangle && geometry.stage && !geometry.stage->contains(point)) {
        return {};
    }
    const float turn = scatter(place.column, place.row, place.sample);
    const float open = hit->shape == Shape::face ? at(face_openness[hit->index], hit->u, hit->v)
                                                 : openness(scene, point, hit->normal, 6, turn);
    const Eigen::Vector3f sun = rays.sun();
    const float slant = std::max(0.0F, hit->normal.dot(sun));
    const bool is_lit = slant > 0.0F && !scene.obstacle(point + kStart_m * hit->normal, sun, 10.0F);
    const float sky = kSkyLight * (0.8F + 0.2F * hit->normal.z()) * (0.15F + 0.85F * open);
    return {(sky + (is_lit ? kSunLight * slant : 0.0F)) * paint, 1.0F};
}

void Tracer::Impl::render_rows(const View& view, std::uint32_t first, std::uint32_t step,
                               Image& image) const {
    const ViewRays rays(view);
    const Eigen::Vector3f eye = view.eye.cast<float>();
    for (std::uint32_t row = first; row < view.size.height; row += step) {
        for (std::uint32_t column = 0; column < view.size.width; ++column) {
            Sample sum;
            for (std::uint32_t i = 0; i < 4; ++i) {
                const Sample one = sample(rays, eye, {column, row, i});
                sum = {sum.light + one.light, sum.opacity + one.opacity};
            }
            std::uint8_t* pixel = &image.rgba[std::size_t{4} * (std::size_t{row} * view.size.width + column)];
            const Colour mean = sum.opacity > 0.0F ? 1.0F / sum.opacity * sum.light : Colour{};
            pixel[0] = srgb_of_linear(mean.red);
            pixel[1] = srgb_of_linear(mean.green);
            pixel[2] = srgb_of_linear(mean.blue);
            pixel[3] = static_cast<std::uint8_t>(std::lround(255.0F * sum.opacity / 4.0F));
        }
    }
}

Tracer::Tracer(const Geometry& geometry) : impl_(std::make_unique<Impl>(geometry)) {}
Tracer::Tracer(Tracer&&) noexcept = default;
Tracer& Tracer::operator=(Tracer&&) noexcept = default;
Tracer::~Tracer() = default;

Image Tracer::render(const View& view) const {
    Image image{view.size.width, view.size.height,
                std::vector<std::uint8_t>(std::size_t{4} * view.size.width * view.size.height)};
    std::thread odd_rows([&] { impl_->render_rows(view, 1, 2, image); });
    impl_->render_rows(view, 0, 2, image);
    odd_rows.join();
    return image;
}

}  // namespace octoskin::report
