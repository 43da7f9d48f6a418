// The shapes of SDF as closed triangle meshes, placed as in the SDF specification: lengths along z, centre at
// the origin. Round shapes are inscribed with 96 facets round the axis: a surface lies at most 1 - cos(pi /
// 96) = 0.054 % of its radius inside the true one.
#pragma once

#include "hw/sim/world/solid.hpp"

namespace octoskin::sim {

[[nodiscard]] TriangleMesh box_mesh(const Eigen::Vector3d& size_m);
[[nodiscard]] TriangleMesh cylinder_mesh(double radius_m, double length_m);
/// `length_m`: of the cylindrical part, without the two hemispheres.
[[nodiscard]] TriangleMesh capsule_mesh(double radius_m, double length_m);
/// A sphere has three equal radii.
[[nodiscard]] TriangleMesh ellipsoid_mesh(const Eigen::Vector3d& radii_m);
/// A rectangle (not closed) in the x-y plane, turned so that its +z becomes `normal` (unit).
[[nodiscard]] TriangleMesh plane_mesh(const Eigen::Vector3d& normal, const Eigen::Vector2d& size_m);

}  // namespace octoskin::sim
