// Which voxels a cone's range speaks of: the core that it has passed, and the cap in which its surface is.
#pragma once

#include <cstdint>
#include <vector>

#include "host/core/voxels/voxel_lattice.hpp"

namespace octoskin {

/// A voxel of a cap: what the beam weighs there, 1 on its axis. Without weight it is seen, and gets no hits.
struct CapVoxel {
    VoxelKey key;
    float weight = 0.0F;
    friend bool operator==(const CapVoxel&, const CapVoxel&) = default;
};

/// A voxel is told by where its centre lies; v: from the sensor to there, d: the axis, r: the range.
struct ConeVoxels {
    /// 0 <= v.d, |v - (v.d) d| <= margin + (v.d) tan(core angle), |v| < r - h, where h is the cap's half
    /// thickness; each once.
    std::vector<VoxelKey> passed;
    /// | |v| - r | <= h, angle of v and d <= cap angle; each once. Empty beyond `hit_range_max_m`.
    std::vector<CapVoxel> cap;
    /// Where its surface most likely is, as far as one reading tells: | |v| - r | <= half an edge, angle of v
    /// and d <= `StationaryModel::angle_share` of the half angle; or, if that is no voxel, the end's own.
    /// Empty where `cap` is.
    std::vector<VoxelKey> middle;
};

}  // namespace octoskin
