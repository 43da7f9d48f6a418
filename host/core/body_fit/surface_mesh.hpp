// The surface of one link as triangles.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <vector>

namespace octoskin {

/// A triangle, or a part of one.
using Triangle = std::array<Eigen::Vector3d, 3>;

/// Triangles in one frame, metres, all finite. The surface may be open, and its triangles may face either
/// way.
struct SurfaceMesh {
    std::vector<Eigen::Vector3d> vertices;
    std::vector<Eigen::Vector3i> triangles;  ///< indices of vertices

    [[nodiscard]] Triangle corners(std::size_t triangle) const {
        const Eigen::Vector3i& at = triangles[triangle];
        return {vertices[static_cast<std::size_t>(at[0])], vertices[static_cast<std::size_t>(at[1])],
                vertices[static_cast<std::size_t>(at[2])]};
    }
};

/// Adds the triangles of `part`, which may be scaled as well as moved: T_mesh_part.
inline void append(const SurfaceMesh& part, const Eigen::Affine3d& T_mesh_part, SurfaceMesh& mesh) {
    const auto first = static_cast<int>(mesh.vertices.size());
    for (const Eigen::Vector3d& vertex : part.vertices) mesh.vertices.push_back(T_mesh_part * vertex);
    for (const Eigen::Vector3i& triangle : part.triangles)
        mesh.triangles.emplace_back(triangle + Eigen::Vector3i::Constant(first));
}

}  // namespace octoskin
