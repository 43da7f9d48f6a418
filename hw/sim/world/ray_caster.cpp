#include "hw/sim/world/ray_caster.hpp"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cassert>
#include <initializer_list>
#include <limits>
#include <map>
#include <new>
#include <utility>

#include "hw/sim/world/polygon_clip.hpp"

namespace octoskin::sim {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr std::size_t kPacket = 8;

/// The plane of a triangle: points p with normal . p = offset.
struct Plane {
    Eigen::Vector3d normal;
    double offset;
};

/// Embree's single precision is precise enough for exact_t() on a tilted triangle if no corner is further
/// away than about 1000 m.
constexpr double kCornerMax_m = 500.0;

/// The triangles of a solid for Embree.
struct Facets {
    std::vector<Eigen::Vector3d> vertices;
    std::vector<Eigen::Vector3i> triangles;
    std::vector<Plane> planes;  ///< per triangle
};

Plane plane_of(const Solid& solid, const Eigen::Vector3i& triangle) {
    const auto& a = solid.vertices[static_cast<std::size_t>(triangle[0])];
    const auto& b = solid.vertices[static_cast<std::size_t>(triangle[1])];
    const auto& c = solid.vertices[static_cast<std::size_t>(triangle[2])];
    const Eigen::Vector3d normal = (b - a).cross(c - a).normalized();
    return {normal, normal.dot(a)};
}

Facets facets_of(const Solid& solid) {
    Facets facets{solid.vertices, solid.triangles, {}};
    for (const auto& triangle : solid.triangles) facets.planes.push_back(plane_of(solid, triangle));
    return facets;
}

bool is_near(const Eigen::Vector3d& vertex) {
    return vertex.cwiseAbs().maxCoeff() <= kCornerMax_m;
}

/// The near part of a solid: each triangle clipped into parts, with the plane of the whole triangle.
Facets near_facets_of(const Solid& solid, const Facets& all) {
    const Eigen::Vector3d corner = Eigen::Vector3d::Constant(kCornerMax_m);
    Facets facets;
    for (std::size_t i = 0; i < all.triangles.size(); ++i) {
        std::vector<Eigen::Vector3d> polygon;
        for (const int vertex : all.triangles[i])
            polygon.push_back(solid.vertices[static_cast<std::size_t>(vertex)]);
        polygon = clipped_to(Eigen::AlignedBox3d(-corner, corner), std::move(polygon),
                             [](const Eigen::Vector3d& p, Eigen::Index axis) { return p[axis]; });
        const int first = static_cast<int>(facets.vertices.size());
        for (int k = 1; k + 1 < static_cast<int>(polygon.size()); ++k) {
            facets.triangles.emplace_back(first, first + k, first + k + 1);
            facets.planes.push_back(all.planes[i]);
        }
        facets.vertices.insert(facets.vertices.end(), polygon.begin(), polygon.end());
    }
    return facets;
}

/// Embree returns null if memory is exhausted; no other failure is possible here.
template <class Pointer>
Pointer made(Pointer pointer) {
    if (pointer == nullptr) throw std::bad_alloc();
    return pointer;
}

RTCGeometry make_geometry(RTCDevice device, const Facets& facets) {
    RTCGeometry geometry = made(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE));
    auto* vertices = static_cast<float*>(made(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), facets.vertices.size())));
    for (const auto& vertex : facets.vertices) {
        vertices = std::copy_n(vertex.cast<float>().eval().data(), 3, vertices);
    }
    auto* indices = static_cast<unsigned*>(
        made(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                     3 * sizeof(unsigned), facets.triangles.size())));
    for (const auto& triangle : facets.triangles) {
        indices = std::copy_n(triangle.cast<unsigned>().eval().data(), 3, indices);
    }
    rtcCommitGeometry(geometry);
    return geometry;
}

RTCScene make_scene(RTCDevice device) {
    RTCScene scene = made(rtcNewScene(device));
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    return scene;
}

}  // namespace

struct RayCaster::Impl {
    RTCDevice device = nullptr;
    RTCScene all = nullptr;
    std::vector<RTCScene> one_solid;
    std::vector<std::vector<Plane>> planes;                  ///< per solid, per triangle of `all`
    std::map<std::uint32_t, std::vector<Plane>> whole_ones;  ///< of `one_solid`, if they differ

    ~Impl() {
        for (RTCScene scene : one_solid) {
            rtcReleaseScene(scene);
        }
        rtcReleaseScene(all);
        rtcReleaseDevice(device);
    }

    /// The test whether a point is inside a solid uses the whole solid, not only its near part.
    void add(const Solid& solid) {
        const auto id = static_cast<std::uint32_t>(one_solid.size());
        one_solid.push_back(make_scene(device));
        Facets facets = facets_of(solid);
        if (std::ranges::all_of(solid.vertices, is_near)) {
            attach(facets, id, {all, one_solid.back()});
        } else {
            attach(facets, id, {one_solid.back()});
            Facets near_ones = near_facets_of(solid, facets);
            whole_ones[id] = std::exchange(facets.planes, std::move(near_ones.planes));
            if (!near_ones.triangles.empty()) attach(near_ones, id, {all});
        }
        rtcCommitScene(one_solid.back());
        planes.push_back(std::move(facets.planes));
    }

    void attach(const Facets& facets, std::uint32_t id, std::initializer_list<RTCScene> scenes) const {
        RTCGeometry geometry = make_geometry(device, facets);
        for (RTCScene scene : scenes) {
            rtcAttachGeometryByID(scene, geometry, id);
        }
        rtcReleaseGeometry(geometry);
    }

    [[nodiscard]] const std::vector<Plane>& whole_planes(std::uint32_t solid) const {
        const auto whole = whole_ones.find(solid);
        return whole == whole_ones.end() ? planes[solid] : whole->second;
    }

    /// `planes_of(solid)`: the plane of each triangle in the scene.
    template <class PlanesOf>
    [[nodiscard]] static std::optional<TriangleHit> cast(RTCScene scene, const PlanesOf& planes_of,
                                                         const Eigen::Vector3d& origin,
                                                         const Eigen::Vector3d& direction, double t_max) {
        RTCRayHit ray{};
        ray.ray.org_x = static_cast<float>(origin.x());
        ray.ray.org_y = static_cast<float>(origin.y());
        ray.ray.org_z = static_cast<float>(origin.z());
        ray.ray.dir_x = static_cast<float>(direction.x());
        ray.ray.dir_y = static_cast<float>(direction.y());
        ray.ray.dir_z = static_cast<float>(direction.z());
        ray.ray.tfar = static_cast<float>(t_max);
        ray.ray.mask = ~0u;
        ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        rtcIntersect1(scene, &context, &ray);
        if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) {
            return std::nullopt;
        }
        const Plane& plane = planes_of(ray.hit.geomID)[ray.hit.primID];
        return TriangleHit{exact_t(plane, origin, direction, ray.ray.tfar), ray.hit.geomID, plane.normal};
    }

    /// Calls `take(i, hit)` for every ray, in order.
    template <class Take>
    void cast_fan(const Eigen::Vector3d& origin, std::span<const Eigen::Vector3d> directions, double t_max,
                  const Take& take) const {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
        for (std::size_t first = 0; first < directions.size(); first += kPacket) {
            const std::size_t count = std::min(kPacket, directions.size() - first);
            alignas(32) RTCRayHit8 packet{};
            alignas(32) int is_valid[kPacket] = {};
            for (std::size_t i = 0; i < count; ++i) {
                is_valid[i] = -1;
                packet.ray.org_x[i] = static_cast<float>(origin.x());
                packet.ray.org_y[i] = static_cast<float>(origin.y());
                packet.ray.org_z[i] = static_cast<float>(origin.z());
                packet.ray.dir_x[i] = static_cast<float>(directions[first + i].x());
                packet.ray.dir_y[i] = static_cast<float>(directions[first + i].y());
                packet.ray.dir_z[i] = static_cast<float>(directions[first + i].z());
                packet.ray.tfar[i] = static_cast<float>(t_max);
                packet.ray.mask[i] = ~0u;
                packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
            }
            rtcIntersect8(is_valid, all, &context, &packet);
            for (std::size_t i = 0; i < count; ++i) {
                take(first + i, hit_of(packet.hit.geomID[i], packet.hit.primID[i], origin,
                                       directions[first + i], packet.ray.tfar[i]));
            }
        }
    }

    /// t is infinity if nothing was found.
    [[nodiscard]] TriangleHit hit_of(unsigned solid, unsigned triangle, const Eigen::Vector3d& origin,
                                     const Eigen::Vector3d& direction, float t_found) const {
        if (solid == RTC_INVALID_GEOMETRY_ID) return {.t = std::numeric_limits<double>::infinity()};
        const Plane& plane = planes[solid][triangle];
        return {exact_t(plane, origin, direction, t_found), solid, plane.normal};
    }

    /// For a ray almost parallel to the plane this is not more precise: Embree's value is kept.
    static double exact_t(const Plane& plane, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                          float t_found) {
        const double speed = plane.normal.dot(direction);
        const double t = (plane.offset - plane.normal.dot(origin)) / speed;
        const double found = static_cast<double>(t_found);
        return std::abs(t - found) <= 1e-4 * (1.0 + found) ? std::max(t, 0.0) : found;
    }
};

RayCaster::RayCaster(const std::vector<Solid>& solids) : impl_(std::make_unique<Impl>()) {
    // One thread: the scenes are small, and a library should not start threads unasked.
    impl_->device = made(rtcNewDevice("threads=1"));
    impl_->all = make_scene(impl_->device);
    for (const Solid& solid : solids) impl_->add(solid);
    rtcCommitScene(impl_->all);
    const RTCError error = rtcGetDeviceError(impl_->device);
    if (error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
    assert(error == RTC_ERROR_NONE);
}

RayCaster::RayCaster(RayCaster&&) noexcept = default;
RayCaster& RayCaster::operator=(RayCaster&&) noexcept = default;
RayCaster::~RayCaster() = default;

std::optional<TriangleHit> RayCaster::cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                           double t_max) const {
    const auto planes_of = [&](unsigned solid) -> const auto& {
        return impl_->planes[solid];
    };
    return Impl::cast(impl_->all, planes_of, origin, direction, t_max);
}

std::optional<TriangleHit> RayCaster::cast_at_solid(std::uint32_t solid, const Eigen::Vector3d& origin,
                                                    const Eigen::Vector3d& direction) const {
    const auto planes_of = [&](unsigned id) -> const auto& {
        return impl_->whole_planes(id);
    };
    return Impl::cast(impl_->one_solid[solid], planes_of, origin, direction, static_cast<double>(kInfinity));
}

void RayCaster::cast_fan(const Eigen::Vector3d& origin, std::span<const Eigen::Vector3d> directions,
                         double t_max, std::span<double> t) const {
    assert(t.size() == directions.size());
    impl_->cast_fan(origin, directions, t_max, [&](std::size_t i, const TriangleHit& hit) { t[i] = hit.t; });
}

void RayCaster::cast_fan(const Eigen::Vector3d& origin, std::span<const Eigen::Vector3d> directions,
                         double t_max, std::span<TriangleHit> hits) const {
    assert(hits.size() == directions.size());
    impl_->cast_fan(origin, directions, t_max, [&](std::size_t i, const TriangleHit& hit) { hits[i] = hit; });
}

}  // namespace octoskin::sim
