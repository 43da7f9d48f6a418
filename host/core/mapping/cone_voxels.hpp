// The voxels that a cone's range is about: the core that it has passed, and the cap that contains its
// surface.
#pragma once

#include <cstdint>
#include <vector>

#include "host/core/voxels/voxel_lattice.hpp"

namespace octoskin {

/// A voxel of a cap, with the beam's weight there: 1 on the axis. A voxel without weight is seen and gets no
/// hits.
struct CapVoxel {
    VoxelKey key;
    float weight = 0.0F;
    friend bool operator==(const CapVoxel&, const CapVoxel&) = default;
};

/// Voxels are tested by their centres. v: from the sensor to the centre, d: the axis, r: the range.
struct ConeVoxels {
    /// 0 <= v.d, |v - (v.d) d| <= margin + (v.d) tan(core angle), |v| < r - h, where h is the cap's half
    /// thickness; each once.
    std::vector<VoxelKey> passed;
    /// | |v| - r | <= h, angle of v and d <= cap angle; each once. Empty beyond `hit_range_max_m`.
    std::vector<CapVoxel> cap;
    /// The most likely position of the surface by one reading: | |v| - r | <= half an edge, angle of v and d
    /// <= `StationaryModel::angle_share` of the half angle; if no voxel fits, the voxel of the beam's end.
    /// Empty if `cap` is empty.
    std::vector<VoxelKey> middle;
};

}  // namespace octoskin
