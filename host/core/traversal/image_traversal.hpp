// Finds the voxels that the rays of one depth image pass: exactly those of OctoMap's computeUpdate, most of
// them without walking a ray.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/core/depth/depth_frame.hpp"
#include "host/core/depth/pixel_rays.hpp"
#include "host/core/traversal/projected_image.hpp"
#include "host/core/traversal/range_pyramid.hpp"
#include "host/core/traversal/ray_pieces.hpp"
#include "host/core/traversal/ray_segments.hpp"
#include "host/core/traversal/visited_grid.hpp"
#include "host/core/voxels/voxel_lattice.hpp"

namespace octoskin {

/// Marks each voxel that a ray passes before its end, in a clear grid that spans the image's rays. It may
/// also mark voxels in which a ray ends at a surface; a caller that takes those for hits is not affected.
/// Keeps its working memory between images.
class ImageTraversal {
  public:
    void mark_passed(const ProjectedImage& image, const PixelRays& pixel_rays, const VoxelLattice& lattice,
                     const Eigen::Isometry3d& T_map_camera, const EndsOfBrick& ends, VisitedGrid& grid);

  private:
    RangePyramid reach_;
    RaySegments ladder_;
    std::vector<RayPiece> pieces_;
    std::vector<std::uint32_t> undecided_;
};

}  // namespace octoskin
