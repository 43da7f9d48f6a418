// The distance of points from a surface of triangles.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "host/core/body_fit/fit_work.hpp"
#include "host/core/body_fit/surface_mesh.hpp"

namespace octoskin {

class MeshDistance {
  public:
    /// A tree of boxes. O(n log n). The mesh has at least one triangle and must outlive this object,
    /// and so must `work`, which counts.
    explicit MeshDistance(const SurfaceMesh& mesh, FitWork* work = nullptr);

    /// Metres from `point` to the nearest point of the surface, at most `max_m`. About a microsecond near it.
    /// `max_m` once the work is spent.
    [[nodiscard]] double operator()(const Eigen::Vector3d& point, double max_m) const;

  private:
    struct Node {
        Eigen::AlignedBox3d box;
        std::uint32_t first = 0;  ///< leaf: of its triangles; else: its left child; the right one follows
        std::uint32_t count = 0;  ///< of triangles; 0: no leaf
    };
    const SurfaceMesh& mesh_;
    FitWork* work_;
    std::vector<std::uint32_t> order_;
    std::vector<Node> nodes_;
};

/// Metres from `point` to the triangle with these corners (Ericson 2005, 5.1.5).
[[nodiscard]] double distance_to_triangle(const Eigen::Vector3d& point, const Eigen::Vector3d& a,
                                          const Eigen::Vector3d& b, const Eigen::Vector3d& c);

}  // namespace octoskin
