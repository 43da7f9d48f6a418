// A solid of the world as triangles, and the checks of its mesh before ray-casting.
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "hw/mesh/triangle_mesh.hpp"

namespace octoskin::sim {

/// One visual of the SDF file: a triangle mesh in the world frame.
struct Solid {
    std::string name;   ///< "model/link/visual"
    std::string model;  ///< the name of the outermost model
    std::vector<Eigen::Vector3d> vertices;
    std::vector<Eigen::Vector3i> triangles;
    bool is_closed = true;  ///< false for a plane or an open mesh, which have no interior
};

/// The same surface with vertices of equal position merged and triangles without area left out. STL files
/// repeat every vertex in every triangle; only the welded mesh can be checked for being closed.
[[nodiscard]] TriangleMesh weld(const TriangleMesh& mesh);

/// True if every edge of a welded mesh belongs to exactly two triangles that run along it in opposite
/// directions.
[[nodiscard]] bool is_closed(const TriangleMesh& mesh);

/// Cubic metres; negative if the triangles of a closed mesh face inwards.
[[nodiscard]] double signed_volume(const TriangleMesh& mesh);

/// Reverses every triangle: inside becomes outside.
void turn_inside_out(TriangleMesh& mesh);

[[nodiscard]] TriangleMesh transformed(const TriangleMesh& mesh, const Eigen::Isometry3d& T_parent_mesh);

}  // namespace octoskin::sim
