// Surfaces for the tests of the fit, made without files.
#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "host/core/body_fit/surface_mesh.hpp"

namespace octoskin {

/// A box around the origin, 12 triangles.
inline SurfaceMesh box_mesh(const Eigen::Vector3d& size_m) {
    SurfaceMesh mesh;
    for (int i = 0; i < 8; ++i) {
        const Eigen::Vector3d corner(i & 1 ? 0.5 : -0.5, i & 2 ? 0.5 : -0.5, i & 4 ? 0.5 : -0.5);
        mesh.vertices.emplace_back(corner.cwiseProduct(size_m));
    }
    constexpr std::array<std::array<int, 4>, 6> kFaces{
        {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
    for (const auto& face : kFaces) {
        mesh.triangles.emplace_back(face[0], face[1], face[2]);
        mesh.triangles.emplace_back(face[0], face[2], face[3]);
    }
    return mesh;
}

/// The surface of a capsule along z around the origin, by rings of `around` points.
inline SurfaceMesh capsule_mesh(double length_m, double radius_m, int around = 48, int rings = 12) {
    SurfaceMesh mesh;
    for (int half = 0; half < 2; ++half) {
        for (int ring = 0; ring <= rings; ++ring) {
            const double rise = (half + static_cast<double>(ring) / rings - 1.0) * 0.5 * std::numbers::pi;
            for (int i = 0; i < around; ++i) {
                const double turn = 2.0 * std::numbers::pi * i / around;
                mesh.vertices.emplace_back(radius_m * std::cos(rise) * std::cos(turn),
                                           radius_m * std::cos(rise) * std::sin(turn),
                                           radius_m * std::sin(rise) + (half - 0.5) * length_m);
            }
        }
    }
    for (int ring = 0; ring <= 2 * rings; ++ring) {
        for (int i = 0; i < around; ++i) {
            const int next = (i + 1) % around;
            mesh.triangles.emplace_back(ring * around + i, ring * around + next, (ring + 1) * around + i);
            mesh.triangles.emplace_back(ring * around + next, (ring + 1) * around + next,
                                        (ring + 1) * around + i);
        }
    }
    return mesh;
}

/// Two boxes of a bent link.
inline SurfaceMesh angle_mesh() {
    SurfaceMesh mesh;
    append(box_mesh({0.3, 0.08, 0.08}), Eigen::Affine3d(Eigen::Translation3d(0.11, 0.0, 0.0)), mesh);
    append(box_mesh({0.08, 0.08, 0.3}), Eigen::Affine3d(Eigen::Translation3d(0.0, 0.0, 0.15)), mesh);
    return mesh;
}

}  // namespace octoskin
