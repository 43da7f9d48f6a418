#include "hw/sim/world/solid.hpp"

#include <array>
#include <map>
#include <utility>

namespace octoskin::sim {

TriangleMesh weld(const TriangleMesh& mesh) {
    TriangleMesh welded;
    std::map<std::array<double, 3>, int> index_of;
    std::vector<int> new_index(mesh.vertices.size());
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        // Adding zero converts -0.0 to 0.0, so that both have one key.
        const Eigen::Vector3d vertex = mesh.vertices[i].array() + 0.0;
        const auto [entry, is_new] = index_of.try_emplace({vertex.x(), vertex.y(), vertex.z()},
                                                          static_cast<int>(welded.vertices.size()));
        if (is_new) {
            welded.vertices.push_back(vertex);
        }
        new_index[i] = entry->second;
    }
    for (const auto& triangle : mesh.triangles) {
        const Eigen::Vector3i corners =
            triangle.unaryExpr([&](int i) { return new_index[static_cast<std::size_t>(i)]; });
        if (corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0]) {
            welded.triangles.push_back(corners);
        }
    }
    return welded;
}

bool is_closed(const TriangleMesh& mesh) {
    std::map<std::pair<int, int>, int> uses;
    for (const auto& triangle : mesh.triangles) {
        for (int i = 0; i < 3; ++i) {
            ++uses[{triangle[i], triangle[(i + 1) % 3]}];
        }
    }
    for (const auto& [edge, count] : uses) {
        const auto opposite = uses.find({edge.second, edge.first});
        if (count != 1 || opposite == uses.end() || opposite->second != 1) {
            return false;
        }
    }
    return !mesh.triangles.empty();
}

double signed_volume(const TriangleMesh& mesh) {
    double six_volumes = 0.0;
    for (const auto& triangle : mesh.triangles) {
        const auto& a = mesh.vertices[static_cast<std::size_t>(triangle[0])];
        const auto& b = mesh.vertices[static_cast<std::size_t>(triangle[1])];
        const auto& c = mesh.vertices[static_cast<std::size_t>(triangle[2])];
        six_volumes += a.dot(b.cross(c));
    }
    return six_volumes / 6.0;
}

void turn_inside_out(TriangleMesh& mesh) {
    for (auto& triangle : mesh.triangles) {
        std::swap(triangle[1], triangle[2]);
    }
}

TriangleMesh transformed(const TriangleMesh& mesh, const Eigen::Isometry3d& T_parent_mesh) {
    TriangleMesh result = mesh;
    for (auto& vertex : result.vertices) {
        vertex = T_parent_mesh * vertex;
    }
    return result;
}

}  // namespace octoskin::sim
