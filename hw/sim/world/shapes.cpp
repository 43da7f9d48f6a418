#include "hw/sim/world/shapes.hpp"

#include <numbers>

namespace octoskin::sim {
namespace {

constexpr int kFacetsAround = 96;
constexpr int kFacetsPoleToEquator = 24;

/// A point of an outline that is rotated about the z axis.
struct ProfilePoint {
    double radius_m;
    double z_m;
};

/// The closed surface of revolution of `rings`, bottom to top, with a pole on the axis below and one above.
TriangleMesh surface_of_revolution(double z_bottom_m, const std::vector<ProfilePoint>& rings,
                                   double z_top_m) {
    TriangleMesh mesh;
    for (const auto& ring : rings) {
        for (int i = 0; i < kFacetsAround; ++i) {
            const double angle = 2.0 * std::numbers::pi * i / kFacetsAround;
            mesh.vertices.emplace_back(ring.radius_m * std::cos(angle), ring.radius_m * std::sin(angle),
                                       ring.z_m);
        }
    }
    const int bottom = static_cast<int>(mesh.vertices.size());
    const int top = bottom + 1;
    mesh.vertices.emplace_back(0.0, 0.0, z_bottom_m);
    mesh.vertices.emplace_back(0.0, 0.0, z_top_m);
    const int rings_count = static_cast<int>(rings.size());
    const auto at = [](int ring, int i) { return ring * kFacetsAround + i % kFacetsAround; };
    for (int i = 0; i < kFacetsAround; ++i) {
        mesh.triangles.emplace_back(bottom, at(0, i + 1), at(0, i));
        for (int ring = 0; ring + 1 < rings_count; ++ring) {
            mesh.triangles.emplace_back(at(ring, i), at(ring, i + 1), at(ring + 1, i + 1));
            mesh.triangles.emplace_back(at(ring, i), at(ring + 1, i + 1), at(ring + 1, i));
        }
        mesh.triangles.emplace_back(top, at(rings_count - 1, i), at(rings_count - 1, i + 1));
    }
    return mesh;
}

}  // namespace

TriangleMesh box_mesh(const Eigen::Vector3d& size_m) {
    TriangleMesh mesh;
    for (int corner = 0; corner < 8; ++corner) {
        const Eigen::Vector3d sign((corner & 1) != 0 ? 0.5 : -0.5, (corner & 2) != 0 ? 0.5 : -0.5,
                                   (corner & 4) != 0 ? 0.5 : -0.5);
        mesh.vertices.emplace_back(sign.cwiseProduct(size_m));
    }
    mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                      {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    return mesh;
}

TriangleMesh cylinder_mesh(double radius_m, double length_m) {
    const double half = length_m / 2.0;
    return surface_of_revolution(-half, {{radius_m, -half}, {radius_m, half}}, half);
}

TriangleMesh capsule_mesh(double radius_m, double length_m) {
    const double half = length_m / 2.0;
    std::vector<ProfilePoint> rings;
    for (int step = 1; step <= kFacetsPoleToEquator; ++step) {
        const double angle = std::numbers::pi / 2.0 * step / kFacetsPoleToEquator;
        rings.push_back({radius_m * std::sin(angle), -half - radius_m * std::cos(angle)});
    }
    for (int step = kFacetsPoleToEquator; step >= 1; --step) {
        const double angle = std::numbers::pi / 2.0 * step / kFacetsPoleToEquator;
        rings.push_back({radius_m * std::sin(angle), half + radius_m * std::cos(angle)});
    }
    return surface_of_revolution(-half - radius_m, rings, half + radius_m);
}

TriangleMesh ellipsoid_mesh(const Eigen::Vector3d& radii_m) {
    std::vector<ProfilePoint> rings;
    for (int step = 1; step < 2 * kFacetsPoleToEquator; ++step) {
        const double angle = std::numbers::pi / 2.0 * step / kFacetsPoleToEquator;
        rings.push_back({std::sin(angle), -std::cos(angle)});
    }
    TriangleMesh mesh = surface_of_revolution(-1.0, rings, 1.0);
    for (auto& vertex : mesh.vertices) {
        vertex = vertex.cwiseProduct(radii_m);
    }
    return mesh;
}

TriangleMesh plane_mesh(const Eigen::Vector3d& normal, const Eigen::Vector2d& size_m) {
    // The half-way rotation from z to the normal; for -z half a turn about x. Eigen's FromTwoVectors costs
    // ten seconds of compile time.
    Eigen::Quaterniond q_plane_z(1.0 + normal.z(), -normal.y(), normal.x(), 0.0);
    q_plane_z = q_plane_z.norm() < 1e-9 ? Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0) : q_plane_z.normalized();
    TriangleMesh mesh;
    for (int corner = 0; corner < 4; ++corner) {
        const Eigen::Vector3d flat((corner & 1) != 0 ? size_m.x() / 2.0 : -size_m.x() / 2.0,
                                   (corner & 2) != 0 ? size_m.y() / 2.0 : -size_m.y() / 2.0, 0.0);
        mesh.vertices.emplace_back(q_plane_z * flat);
    }
    mesh.triangles = {{0, 1, 3}, {0, 3, 2}};
    return mesh;
}

}  // namespace octoskin::sim
