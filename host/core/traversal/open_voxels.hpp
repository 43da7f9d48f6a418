// Tests voxels for which the nearest pixel gives no decision: all pixels that see the voxel are tested.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "host/core/traversal/brick_visibility.hpp"
#include "host/core/traversal/certain_view.hpp"
#include "host/core/traversal/projected_image.hpp"
#include "host/core/traversal/ray_pieces.hpp"
#include "host/core/voxels/voxel_lattice.hpp"

namespace octoskin {

/// Keeps references to all arguments except the lattice.
class OpenVoxels {
  public:
    OpenVoxels(const CertainView& view, const ProjectedImage& image, const VoxelLattice& lattice,
               const BrickVisibility& picture);

    /// True if a ray certainly passes the voxel. Otherwise adds the rays that possibly pass it to `pieces`.
    [[nodiscard]] bool is_passed(const Eigen::Vector3d& centre_map, std::vector<RayPiece>& pieces);

  private:
    const CertainView& view_;
    const ProjectedImage& image_;
    const BrickVisibility& picture_;
    Eigen::Vector3d origin_;            ///< map frame
    Eigen::Vector3d centre_of_origin_;  ///< centre of the voxel that contains it, map frame
    double half_depth_m_;
    Eigen::Vector3d first_;  ///< the ray of pixel (0, 0), map frame, per metre of depth
    Eigen::Vector3d next_u_;
    Eigen::Vector3d next_v_;
    std::vector<std::uint32_t> perhaps_;
};

}  // namespace octoskin
