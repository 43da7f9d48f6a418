// Voxels that the nearest pixel does not decide: all pixels that see one are asked.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "host/core/traversal/certain_view.hpp"
#include "host/core/traversal/picture_test.hpp"
#include "host/core/traversal/placed_image.hpp"
#include "host/core/traversal/ray_pieces.hpp"
#include "host/core/voxels/voxel_lattice.hpp"

namespace octoskin {

/// Keeps references to all but the lattice.
class OpenVoxels {
  public:
    OpenVoxels(const CertainView& view, const PlacedImage& image, const VoxelLattice& lattice,
               const PictureTest& picture);

    /// True if a ray passes the voxel for certain; else `pieces` gets the rays that perhaps pass it.
    [[nodiscard]] bool is_passed(const Eigen::Vector3d& centre_map, std::vector<RayPiece>& pieces);

  private:
    const CertainView& view_;
    const PlacedImage& image_;
    const PictureTest& picture_;
    Eigen::Vector3d origin_;            ///< map frame
    Eigen::Vector3d centre_of_origin_;  ///< of the voxel that holds it, map frame
    double half_depth_m_;
    Eigen::Vector3d first_;  ///< the ray of pixel (0, 0), map frame, per metre of depth
    Eigen::Vector3d next_u_;
    Eigen::Vector3d next_v_;
    std::vector<std::uint32_t> perhaps_;
};

}  // namespace octoskin
