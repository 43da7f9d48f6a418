// Finds the voxels that the rays of one depth image pass: exactly those of OctoMap's computeUpdate, most of
// them without walking a ray.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/core/depth/depth_frame.hpp"
#include "host/core/depth/pixel_rays.hpp"
#include "host/core/traversal/mark_grid.hpp"
#include "host/core/traversal/placed_image.hpp"
#include "host/core/traversal/ray_pieces.hpp"
#include "host/core/traversal/reach_windows.hpp"
#include "host/core/traversal/walk_ladder.hpp"
#include "host/core/voxels/voxel_lattice.hpp"

namespace octoskin {

/// Marks each voxel that a ray passes before its end, in a clear grid that spans the image's rays. It may
/// also mark voxels in which a ray ends at a surface; a caller that takes those for hits is not affected.
/// Keeps its working memory between images.
class ImageTraversal {
  public:
    void mark_passed(const PlacedImage& image, const PixelRays& pixel_rays, const VoxelLattice& lattice,
                     const Eigen::Isometry3d& T_map_camera, const EndsOfBrick& ends, MarkGrid& grid);

  private:
    ReachWindows reach_;
    WalkLadder ladder_;
    std::vector<RayPiece> pieces_;
    std::vector<std::uint32_t> undecided_;
};

}  // namespace octoskin
