#include "hw/sim/arm/body.hpp"

#include <algorithm>
#include <cmath>

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

std::optional<double> cast_robot(const std::vector<rig::Capsule>& capsules, const Arm::LinkPoses& poses,
                                 const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                 const std::vector<std::string>& ignored) {
    return cast_body(posed_body(capsules, poses, ignored), origin, direction);
}

}  // namespace octoskin::sim
