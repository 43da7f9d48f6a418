// Finds the voxels that the rays of a depth image pass by walking each ray: for a camera with a lens, and for
// coordinates at which single precision is coarse. PassedVoxels is quicker for all others.
#pragma once

#include <cstdint>
#include <vector>

#include "host/core/traversal/projected_image.hpp"
#include "host/core/traversal/ray_pieces.hpp"
#include "host/core/traversal/visited_grid.hpp"
#include "host/core/voxels/voxel_lattice.hpp"

namespace octoskin {

/// Marks each voxel that OctoMap's computeRayKeys visits of a ray, in a clear grid that spans the image's
/// rays. Keeps its working memory between images.
class ImageTraversal {
  public:
    void mark_passed(const ProjectedImage& image, const VoxelLattice& lattice, VisitedGrid& grid);

  private:
    std::vector<RayPiece> pieces_;
    std::vector<std::uint32_t> undecided_;
};

}  // namespace octoskin
