// A surface of triangles.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace octoskin {

/// A triangle mesh, metres. The corners of a triangle run anticlockwise seen from outside.
struct TriangleMesh {
    std::vector<Eigen::Vector3d> vertices;
    std::vector<Eigen::Vector3i> triangles;
};

}  // namespace octoskin
