#include "host/core/traversal/image_traversal.hpp"

#include <cassert>
#include <limits>

namespace octoskin {

void ImageTraversal::mark_passed(const ProjectedImage& image, const VoxelLattice& lattice,
                                 VisitedGrid& grid) {
    pieces_.clear();
    for (std::uint32_t pixel = 0; pixel < image.pixels(); ++pixel) {
        if (image.reach_m[pixel] >= 0.0F)
            pieces_.push_back({pixel, 0.0F, std::numeric_limits<float>::infinity()});
    }
    undecided_.clear();
    walk_pieces(image, lattice, pieces_, grid, undecided_);
    assert(undecided_.empty());
}

}  // namespace octoskin
