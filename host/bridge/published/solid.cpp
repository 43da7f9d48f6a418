#include "host/bridge/published/solid.hpp"

#include <algorithm>
#include <cmath>

namespace octoskin::bridge {
namespace {

/// From a point in the plane of (radius, height) to the rectangle 0..radius, -half..half.
double to_rectangle(double rho, double z, double radius, double half) {
    const double outside_rho = std::max(rho - radius, 0.0);
    const double outside_z = std::max(std::abs(z) - half, 0.0);
    return std::hypot(outside_rho, outside_z);
}

double to_segment(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    const Eigen::Vector2d along = b - a;
    const double length_squared = along.squaredNorm();
    const double t = length_squared > 0.0 ? std::clamp((p - a).dot(along) / length_squared, 0.0, 1.0) : 0.0;
    return (p - a - t * along).norm();
}

/// The triangle of the axis, the tip and the rim.
double to_cone(double rho, double z, const Cone& cone) {
    const double half = cone.half_height_m;
    const double share = half > 0.0 ? (half - z) / (2.0 * half) : 1.0;  // 0 at the tip, 1 at the base
    if (std::abs(z) <= half && rho <= share * cone.radius_m) return 0.0;
    const Eigen::Vector2d p(rho, z);
    const Eigen::Vector2d rim(cone.radius_m, -half);
    return std::min(to_segment(p, {0.0, half}, rim), to_segment(p, {0.0, -half}, rim));
}

/// The nearest point of a triangle (Ericson, Real-Time Collision Detection, 5.1.5).
double to_triangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                   const Eigen::Vector3d& c) {
    const Eigen::Vector3d ab = b - a;
    const Eigen::Vector3d ac = c - a;
    const Eigen::Vector3d normal = ab.cross(ac);
    const auto to_edge = [&p](const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
        const Eigen::Vector3d along = to - from;
        const double length_squared = along.squaredNorm();
        const double t =
            length_squared > 0.0 ? std::clamp((p - from).dot(along) / length_squared, 0.0, 1.0) : 0.0;
        return (p - from - t * along).norm();
    };
    const bool is_above = normal.cross(ab).dot(p - a) >= 0.0 && normal.cross(c - b).dot(p - b) >= 0.0 &&
                          normal.cross(a - c).dot(p - c) >= 0.0;
    if (is_above && normal.squaredNorm() > 0.0) return std::abs(normal.normalized().dot(p - a));
    return std::min({to_edge(a, b), to_edge(b, c), to_edge(c, a)});
}

/// The solid angle of a triangle as seen from p (Van Oosterom and Strackee 1983).
double solid_angle(const Eigen::Vector3d& p, const Eigen::Vector3d& a_in, const Eigen::Vector3d& b_in,
                   const Eigen::Vector3d& c_in) {
    const Eigen::Vector3d a = a_in - p;
    const Eigen::Vector3d b = b_in - p;
    const Eigen::Vector3d c = c_in - p;
    const double la = a.norm();
    const double lb = b.norm();
    const double lc = c.norm();
    return 2.0 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}

/// Inside, the solid angles of a closed surface add up to 4 pi; the sign is the orientation's.
bool is_within_mesh(const Eigen::Vector3d& p, const MeshSolid& mesh, double distance_m) {
    double angle = 0.0;
    for (const auto& [i, j, k] : mesh.triangles) {
        const Eigen::Vector3d& a = mesh.vertices[i];
        const Eigen::Vector3d& b = mesh.vertices[j];
        const Eigen::Vector3d& c = mesh.vertices[k];
        if (to_triangle(p, a, b, c) <= distance_m) return true;
        angle += solid_angle(p, a, b, c);
    }
    constexpr double kHalfOfInside = 6.283185307179586;
    return std::abs(angle) > kHalfOfInside;
}

template <class... F>
struct Overloaded : F... {
    using F::operator()...;
};
template <class... F>
Overloaded(F...) -> Overloaded<F...>;

}  // namespace

Eigen::Vector3d half_extent(const Solid& solid) {
    return std::visit(
        Overloaded{
            [](const Box& box) { return box.half; },
            [](const Ball& ball) { return Eigen::Vector3d(Eigen::Vector3d::Constant(ball.radius_m)); },
            [](const Cylinder& one) {
                return Eigen::Vector3d(one.radius_m, one.radius_m, one.half_height_m);
            },
            [](const Cone& one) { return Eigen::Vector3d(one.radius_m, one.radius_m, one.half_height_m); },
            [](const std::shared_ptr<const MeshSolid>& mesh) {
                Eigen::Vector3d half = Eigen::Vector3d::Zero();
                for (const Eigen::Vector3d& vertex : mesh->vertices) half = half.cwiseMax(vertex.cwiseAbs());
                return half;
            }},
        solid.shape);
}

std::size_t work_for(const Solid& solid) noexcept {
    const auto* const mesh = std::get_if<std::shared_ptr<const MeshSolid>>(&solid.shape);
    return mesh == nullptr ? 1 : (*mesh)->triangles.size();
}

bool is_within(const Solid& solid, const Eigen::Vector3d& p_map, double distance_m) {
    const Eigen::Vector3d p = solid.T_map_solid.inverse() * p_map;
    const double rho = std::hypot(p.x(), p.y());
    return std::visit(
        Overloaded{
            [&](const Box& box) { return (p.cwiseAbs() - box.half).cwiseMax(0.0).norm() <= distance_m; },
            [&](const Ball& ball) { return p.norm() <= ball.radius_m + distance_m; },
            [&](const Cylinder& one) {
                return to_rectangle(rho, p.z(), one.radius_m, one.half_height_m) <= distance_m;
            },
            [&](const Cone& one) { return to_cone(rho, p.z(), one) <= distance_m; },
            [&](const std::shared_ptr<const MeshSolid>& mesh) {
                return is_within_mesh(p, *mesh, distance_m);
            }},
        solid.shape);
}

}  // namespace octoskin::bridge
