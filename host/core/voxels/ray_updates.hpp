// One term for all voxels of one ray at once: of what walk_ray_keys() visits, without walking.
#pragma once

#include <span>
#include <vector>

#include "host/core/voxels/ray_walk.hpp"
#include "host/core/voxels/voxel_update.hpp"

namespace octoskin {

/// One update for each voxel that walk_ray_keys() visits, in its order, at the beginning of `buffer`, which
/// is made longer where need be, so that one more has room behind them. A step from voxel to voxel must wait
/// for the one before, and which axis it goes along no processor foresees. So no step is taken here: for each
/// face that the ray crosses it is worked out how many faces of the other two axes it has crossed before,
/// several faces at a time, which says at once where in the order the voxel behind that face comes, and which
/// one it is. Where two faces are crossed so close together that rounding decides which comes first, or the
/// ray ends so close behind a face that rounding decides whether it gets there, the ray is walked. O(voxels),
/// about 2 ns each. Throws std::bad_alloc.
[[nodiscard]] std::span<VoxelUpdate> list_ray_updates(const Ray& ray, float log_odds,
                                                      std::vector<VoxelUpdate>& buffer);

}  // namespace octoskin
