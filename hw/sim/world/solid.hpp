// A solid of the world as triangles, and what must be known of its mesh before rays are cast at it.
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

namespace octoskin::sim {

/// A triangle mesh, metres. The corners of a triangle run anticlockwise seen from outside.
struct TriangleMesh {
    std::vector<Eigen::Vector3d> vertices;
    std::vector<Eigen::Vector3i> triangles;
};

/// One visual of the SDF file: a triangle mesh in the world frame.
struct Solid {
    std::string name;   ///< "model/link/visual"
    std::string model;  ///< the name of the outermost model
    std::vector<Eigen::Vector3d> vertices;
    std::vector<Eigen::Vector3i> triangles;
    bool is_closed = true;  ///< a plane or an open mesh is not: it has a surface but no interior
};

/// The same surface with vertices of equal position merged and triangles without area left out. STL files
/// repeat every vertex in every triangle; whether a mesh is closed can only be told afterwards.
[[nodiscard]] TriangleMesh weld(const TriangleMesh& mesh);

/// True if every edge of a welded mesh belongs to exactly two triangles that run along it in opposite
/// directions.
[[nodiscard]] bool is_closed(const TriangleMesh& mesh);

/// Cubic metres; negative if the triangles of a closed mesh face inwards.
[[nodiscard]] double signed_volume(const TriangleMesh& mesh);

/// Turns every triangle over: inside becomes outside.
void turn_inside_out(TriangleMesh& mesh);

[[nodiscard]] TriangleMesh transformed(const TriangleMesh& mesh, const Eigen::Isometry3d& T_parent_mesh);

}  // namespace octoskin::sim
