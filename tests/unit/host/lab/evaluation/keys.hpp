// Small grids by hand: voxel keys counted from the origin, worlds of one box.
#pragma once

#include "host/lab/evaluation/voxel_grid.hpp"
#include "hw/sim/world/shapes.hpp"
#include "hw/sim/world/world.hpp"

namespace octoskin::evaluation {

/// The voxel (x, y, z) steps from the one whose lower corner is the origin.
constexpr VoxelKey key(int x, int y, int z) {
    return {static_cast<std::uint16_t>(kOriginKey + x), static_cast<std::uint16_t>(kOriginKey + y),
            static_cast<std::uint16_t>(kOriginKey + z)};
}

/// A row of voxels along x from the origin.
constexpr KeyBox row(int voxels) {
    return {key(0, 0, 0), key(voxels - 1, 0, 0)};
}

inline sim::Solid box(const std::string& model, const Eigen::Vector3d& min, const Eigen::Vector3d& max) {
    const TriangleMesh mesh = sim::box_mesh(max - min);
    sim::Solid solid{model + "/link/visual", model, mesh.vertices, mesh.triangles, true};
    for (auto& vertex : solid.vertices) {
        vertex += (min + max) / 2.0;
    }
    return solid;
}

}  // namespace octoskin::evaluation
