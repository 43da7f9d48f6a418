#include "host/core/traversal/image_traversal.hpp"

#include <limits>

#include "host/core/traversal/certain_view.hpp"

namespace octoskin {

void ImageTraversal::mark_passed(const ProjectedImage& image, const PixelRays& pixel_rays,
                                 const VoxelLattice& lattice, const Eigen::Isometry3d& T_map_camera,
                                 const EndsOfBrick& ends, VisitedGrid& grid) {
    const CertainView view(pixel_rays.camera(), lattice, T_map_camera, image);
    pieces_.clear();
    reach_.take(image);
    mark_certain_voxels(view, image, reach_, lattice, ends, grid, pieces_);
    if (!view.is_by_voxel) ladder_.find_pieces(view, image, pieces_);
    undecided_.clear();
    walk_pieces(image, lattice, pieces_, grid, undecided_);

    pieces_.clear();
    for (const std::uint32_t pixel : undecided_) {
        pieces_.push_back({pixel, 0.0F, std::numeric_limits<float>::infinity()});
    }
    walk_pieces(image, lattice, pieces_, grid, undecided_);
}

}  // namespace octoskin
