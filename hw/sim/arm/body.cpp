#include "hw/sim/arm/body.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace octoskin::sim {
namespace {

/// The smaller root of a t^2 + 2 b t + c = 0 (a > 0); empty if there is none or if it is negative.
std::optional<double> entry_of(double a, double b, double c) {
    const double discriminant = b * b - a * c;
    if (discriminant < 0.0) {
        return std::nullopt;
    }
    const double t = (-b - std::sqrt(discriminant)) / a;
    return t >= 0.0 ? std::optional(t) : std::nullopt;
}

std::optional<double> cast_sphere(const Eigen::Vector3d& centre, double radius_m,
                                  const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
    const Eigen::Vector3d offset = origin - centre;
    return entry_of(direction.squaredNorm(), direction.dot(offset),
                    offset.squaredNorm() - radius_m * radius_m);
}

/// Intersects the lateral surface between the capsule's two ends.
std::optional<double> cast_wall(const BodyCapsule& capsule, const Eigen::Vector3d& origin,
                                const Eigen::Vector3d& direction) {
    const Eigen::Vector3d along = capsule.p_base_b - capsule.p_base_a;
    const double length = along.norm();
    if (length == 0.0) {
        return std::nullopt;
    }
    const Eigen::Vector3d axis = along / length;
    const Eigen::Vector3d offset = origin - capsule.p_base_a;
    // Projected along the axis: a circle and a line in the plane.
    const Eigen::Vector3d flat_direction = direction - axis.dot(direction) * axis;
    const Eigen::Vector3d flat_offset = offset - axis.dot(offset) * axis;
    const double speed = flat_direction.squaredNorm();
    if (speed <= 1e-24 * direction.squaredNorm()) {
        return std::nullopt;  // parallel to the axis: it can only enter through an end
    }
    const auto t = entry_of(speed, flat_direction.dot(flat_offset),
                            flat_offset.squaredNorm() - capsule.radius_m * capsule.radius_m);
    if (!t) {
        return std::nullopt;
    }
    const double height = axis.dot(offset + *t * direction);
    return height >= 0.0 && height <= length ? t : std::nullopt;
}

/// From the nearest point of the capsule's segment to `point`.
Eigen::Vector3d offset_from_axis(const BodyCapsule& capsule, const Eigen::Vector3d& point) {
    const Eigen::Vector3d along = capsule.p_base_b - capsule.p_base_a;
    const double length_squared = along.squaredNorm();
    const double part = length_squared == 0.0
                            ? 0.0
                            : std::clamp((point - capsule.p_base_a).dot(along) / length_squared, 0.0, 1.0);
    return point - capsule.p_base_a - part * along;
}

bool is_inside(const BodyCapsule& capsule, const Eigen::Vector3d& point) {
    return offset_from_axis(capsule, point).squaredNorm() <= capsule.radius_m * capsule.radius_m;
}

std::optional<double> nearer(std::optional<double> a, std::optional<double> b) {
    return !a || (b && *b < *a) ? b : a;
}

}  // namespace

std::vector<BodyCapsule> posed_body(const std::vector<rig::Capsule>& capsules, const Arm::LinkPoses& poses,
                                    const std::vector<std::string>& ignored) {
    std::vector<BodyCapsule> body;
    for (const rig::Capsule& capsule : capsules) {
        const auto pose = poses.find(capsule.link);
        if (pose != poses.end() && std::find(ignored.begin(), ignored.end(), capsule.link) == ignored.end()) {
            body.push_back(
                {pose->second * capsule.p_link_a, pose->second * capsule.p_link_b, capsule.radius_m});
        }
    }
    return body;
}

std::optional<double> cast_capsule(const BodyCapsule& capsule, const Eigen::Vector3d& origin,
                                   const Eigen::Vector3d& direction) {
    if (is_inside(capsule, origin)) {
        return 0.0;
    }
    const auto a = cast_sphere(capsule.p_base_a, capsule.radius_m, origin, direction);
    const auto b = cast_sphere(capsule.p_base_b, capsule.radius_m, origin, direction);
    return nearer(nearer(a, b), cast_wall(capsule, origin, direction));
}

Eigen::Vector3d outward_normal(const BodyCapsule& capsule, const Eigen::Vector3d& p_base) {
    return offset_from_axis(capsule, p_base).normalized();
}

std::optional<double> cast_body(const std::vector<BodyCapsule>& body, const Eigen::Vector3d& origin,
                                const Eigen::Vector3d& direction) {
    std::optional<double> nearest;
    for (const BodyCapsule& capsule : body) {
        nearest = nearer(nearest, cast_capsule(capsule, origin, direction));
    }
    return nearest;
}

MeshBody::MeshBody(const LinkMesh& surface) : link_(surface.link) {
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& vertex : surface.mesh.vertices) box.extend(vertex);
    p_link_middle_ = box.center();
    for (const Eigen::Vector3d& vertex : surface.mesh.vertices)
        radius_m_ = std::max(radius_m_, (vertex - p_link_middle_).norm());
    Solid solid{.name = surface.link, .model = {}, .vertices = {}, .triangles = {}, .is_closed = false};
    solid.vertices = surface.mesh.vertices;
    solid.triangles = surface.mesh.triangles;
    rays_ = std::make_shared<const RayCaster>(std::vector{std::move(solid)});
}

void PosedMesh::cast_fan(const Eigen::Vector3d& origin, std::span<const Eigen::Vector3d> directions,
                         double t_max, std::span<TriangleHit> hits) const {
    const Eigen::Isometry3d T_link_frame = T_frame_link.inverse();
    std::vector<Eigen::Vector3d> directions_link;
    directions_link.reserve(directions.size());
    for (const Eigen::Vector3d& direction : directions)
        directions_link.emplace_back(T_link_frame.linear() * direction);
    mesh->rays().cast_fan(T_link_frame * origin, directions_link, t_max, hits);
    for (TriangleHit& hit : hits) hit.normal = T_frame_link.linear() * hit.normal;
}

std::optional<double> PosedBody::cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                      double t_max) const {
    auto nearest = cast_body(capsules, origin, direction);
    if (nearest && *nearest > t_max) nearest.reset();
    for (const PosedMesh& mesh : meshes) {
        TriangleHit hit;
        mesh.cast_fan(origin, {&direction, 1}, t_max, {&hit, 1});
        if (hit.t <= t_max) nearest = nearer(nearest, hit.t);
    }
    return nearest;
}

Body::Body(std::vector<rig::Capsule> capsules, const std::vector<LinkMesh>& meshes)
    : capsules_(std::move(capsules)) {
    for (const LinkMesh& mesh : meshes) meshes_.emplace_back(mesh);
}

PosedBody Body::at(const Arm::LinkPoses& poses, const std::vector<std::string>& ignored) const {
    PosedBody body(posed_body(capsules_, poses, ignored));
    for (const MeshBody& mesh : meshes_) {
        const auto pose = poses.find(mesh.link());
        if (pose != poses.end() && std::ranges::find(ignored, mesh.link()) == ignored.end())
            body.meshes.push_back({&mesh, pose->second});
    }
    return body;
}

}  // namespace octoskin::sim
