#include "host/core/voxels/voxel_lattice.hpp"

#include <cassert>
#include <cmath>

namespace octoskin {

VoxelLattice::VoxelLattice(double resolution_m)
    : resolution_m_(resolution_m), voxels_per_m_(1.0 / resolution_m) {
    assert(std::isfinite(resolution_m) && resolution_m > 0.0);
    assert(std::isfinite(voxels_per_m_));
}

}  // namespace octoskin
