// The boxes around a mesh and around capsules, along the axes of their frame.
#pragma once

#include <Eigen/Geometry>
#include <span>

#include "host/core/body_fit/surface_mesh.hpp"
#include "host/core/kinematics/capsule.hpp"

namespace octoskin {

/// Empty without vertices.
[[nodiscard]] inline Eigen::AlignedBox3d box_of(const SurfaceMesh& mesh) {
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& vertex : mesh.vertices) box.extend(vertex);
    return box;
}

/// Empty without capsules.
[[nodiscard]] inline Eigen::AlignedBox3d box_of(std::span<const PosedCapsule> capsules) {
    Eigen::AlignedBox3d box;
    for (const PosedCapsule& capsule : capsules) {
        const Eigen::Vector3d radius = Eigen::Vector3d::Constant(capsule.radius_m);
        box.extend(capsule.p_a.cwiseMin(capsule.p_b) - radius);
        box.extend(capsule.p_a.cwiseMax(capsule.p_b) + radius);
    }
    return box;
}

}  // namespace octoskin
