// How much space a capsule takes that the link does not: a grid of weights with sums along its rows.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "host/core/body_fit/convex_hull.hpp"
#include "host/core/body_fit/mesh_distance.hpp"
#include "host/core/kinematics/capsule.hpp"

namespace octoskin {

/// Voxels around a link. A voxel's weight is small within the convex hull, 1 outside, and more the farther it
/// is from the mesh. Excess is in voxels, weighted.
class ExcessField {
  public:
    /// `hull`: null if the mesh has none (it is flat). O(voxels * hull faces).
    ExcessField(const SurfaceMesh& mesh, const MeshDistance& distance, const ConvexHull* hull);

    /// Leaves out what these capsules take, until the next call. O(voxels).
    void take_out(std::span<const PosedCapsule> taken);
    /// The weights of the voxels in the capsule that are not taken out. O(rows of the grid that it passes).
    [[nodiscard]] double excess(const PosedCapsule& capsule) const;
    [[nodiscard]] double voxel_m3() const noexcept { return side_m_ * side_m_ * side_m_; }

  private:
    struct Row {
        int y = 0;
        int z = 0;
        double from = 0.0;  ///< in voxels, within the grid
        double to = 0.0;
    };
    template <typename Use>
    void for_each_row(const PosedCapsule& capsule, Use&& use) const;
    template <typename Use>
    void for_each_voxel(Use&& use) const;
    [[nodiscard]] std::size_t row_start(int y, int z) const {
        return static_cast<std::size_t>(z * size_.y() + y) * static_cast<std::size_t>(size_.x());
    }

    Eigen::Vector3d origin_m_ = Eigen::Vector3d::Zero();
    double side_m_ = 0.0;
    Eigen::Vector3i size_ = Eigen::Vector3i::Zero();
    std::vector<float> weights_;
    std::vector<float> sums_;  ///< along x, of what is not taken out: one more than voxels in a row
};

}  // namespace octoskin
