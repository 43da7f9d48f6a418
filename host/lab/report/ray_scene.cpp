#include "host/lab/report/ray_scene.hpp"

#include <embree3/rtcore.h>

#include <array>
#include <cassert>
#include <limits>
#include <new>

namespace octoskin::report {
namespace {

template <class Handle, void (*release)(Handle)>
struct Releaser {
    using pointer = Handle;
    void operator()(Handle handle) const { release(handle); }
};
using Device = std::unique_ptr<RTCDevice, Releaser<RTCDevice, rtcReleaseDevice>>;
using Scene = std::unique_ptr<RTCScene, Releaser<RTCScene, rtcReleaseScene>>;
using EmbreeGeometry = std::unique_ptr<RTCGeometry, Releaser<RTCGeometry, rtcReleaseGeometry>>;

void put(float* to, const Eigen::Vector3f& point) {
    to[0] = point.x();
    to[1] = point.y();
    to[2] = point.z();
}

/// Faces and triangles: every polygon has corners of its own.
template <class Polygon>
EmbreeGeometry polygons(RTCDevice device, RTCGeometryType type, const std::vector<Polygon>& list) {
    constexpr std::size_t kCorners = std::tuple_size_v<decltype(Polygon::corners)>;
    EmbreeGeometry geometry(rtcNewGeometry(device, type));
    const std::size_t count = list.size() * kCorners;
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), count));
    auto* indices = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
        geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, kCorners == 4 ? RTC_FORMAT_UINT4 : RTC_FORMAT_UINT3,
        kCorners * sizeof(std::uint32_t), list.size()));
    if (vertices == nullptr || indices == nullptr) throw std::bad_alloc();  // no other failure is possible
    for (std::size_t i = 0; i < count; ++i) {
        put(vertices + 3 * i, list[i / kCorners].corners[i % kCorners]);
        indices[i] = static_cast<std::uint32_t>(i);
    }
    return geometry;
}

/// Each rod is a curve of one linear segment with round ends.
EmbreeGeometry rods(RTCDevice device, const std::vector<Rod>& list) {
    EmbreeGeometry geometry(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_ROUND_LINEAR_CURVE));
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 4 * sizeof(float), 2 * list.size()));
    auto* indices = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
        geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT, sizeof(std::uint32_t), list.size()));
    if (vertices == nullptr || indices == nullptr) throw std::bad_alloc();  // no other failure is possible
    for (std::size_t i = 0; i < list.size(); ++i) {
        put(vertices + 8 * i, list[i].a);
        put(vertices + 8 * i + 4, list[i].b);
        vertices[8 * i + 3] = list[i].radius_m;
        vertices[8 * i + 7] = list[i].radius_m;
        indices[i] = static_cast<std::uint32_t>(2 * i);
    }
    return geometry;
}

constexpr std::array<Shape, 4> kShapes = {Shape::face, Shape::triangle, Shape::body, Shape::line};

}  // namespace

struct RayScene::Impl {
    Device device{rtcNewDevice("threads=1")};
    Scene visible{rtcNewScene(device.get())};
    Scene opaque{rtcNewScene(device.get())};

    /// Geometries are numbered by their shape. `make` is called only for a list that is not empty.
    template <class List, class Make>
    void add(Shape shape, const List& list, const Make& make) {
        if (list.empty()) {
            return;
        }
        const EmbreeGeometry geometry = make(list);
        rtcCommitGeometry(geometry.get());
        rtcAttachGeometryByID(visible.get(), geometry.get(), static_cast<unsigned>(shape));
        if (shape != Shape::line) {
            rtcAttachGeometryByID(opaque.get(), geometry.get(), static_cast<unsigned>(shape));
        }
    }
};

RayScene::RayScene(const Geometry& geometry) : impl_(std::make_unique<Impl>()) {
    RTCDevice device = impl_->device.get();
    if (device == nullptr) throw std::bad_alloc();
    const auto make_rods = [device](const auto& list) { return rods(device, list); };
    impl_->add(Shape::face, geometry.faces,
               [device](const auto& list) { return polygons(device, RTC_GEOMETRY_TYPE_QUAD, list); });
    impl_->add(Shape::triangle, geometry.triangles,
               [device](const auto& list) { return polygons(device, RTC_GEOMETRY_TYPE_TRIANGLE, list); });
    impl_->add(Shape::body, geometry.bodies, make_rods);
    impl_->add(Shape::line, geometry.lines, make_rods);
    rtcCommitScene(impl_->visible.get());
    rtcCommitScene(impl_->opaque.get());
}

RayScene::RayScene(RayScene&&) noexcept = default;
RayScene& RayScene::operator=(RayScene&&) noexcept = default;
RayScene::~RayScene() = default;

namespace {

RTCRayHit ray_from(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float range_max_m) {
    RTCRayHit ray{};
    ray.ray.org_x = origin.x();
    ray.ray.org_y = origin.y();
    ray.ray.org_z = origin.z();
    ray.ray.dir_x = direction.x();
    ray.ray.dir_y = direction.y();
    ray.ray.dir_z = direction.z();
    ray.ray.tfar = range_max_m;
    ray.ray.mask = 0xFFFFFFFFU;
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    return ray;
}

}  // namespace

std::optional<SceneHit> RayScene::first_hit(const Eigen::Vector3f& origin,
                                            const Eigen::Vector3f& direction) const {
    RTCRayHit ray = ray_from(origin, direction, std::numeric_limits<float>::infinity());
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcIntersect1(impl_->visible.get(), &context, &ray);
    if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) {
        return std::nullopt;
    }
    Eigen::Vector3f normal = Eigen::Vector3f(ray.hit.Ng_x, ray.hit.Ng_y, ray.hit.Ng_z).normalized();
    if (normal.dot(direction) > 0.0F) {
        normal = -normal;
    }
    return SceneHit{ray.ray.tfar, kShapes[ray.hit.geomID], ray.hit.primID, ray.hit.u, ray.hit.v, normal};
}

std::optional<float> RayScene::obstacle(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction,
                                        float range_max_m) const {
    RTCRayHit ray = ray_from(origin, direction, range_max_m);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(impl_->opaque.get(), &context, &ray);
    return ray.hit.geomID == RTC_INVALID_GEOMETRY_ID ? std::nullopt : std::optional(ray.ray.tfar);
}

}  // namespace octoskin::report
