// All voxels of one ray at once: what walk_ray_keys() visits, without walking.
#pragma once

#include <vector>

#include "host/core/voxels/ray_walk.hpp"

namespace octoskin {

/// Sets `keys` to those that walk_ray_keys() visits, in its order. A step from voxel to voxel must wait for
/// the one before, and which axis it goes along no processor foresees. So no step is taken here: for each
/// face that the ray crosses it is worked out how many faces of the other two axes it has crossed before,
/// several faces at a time, which says at once where in the order the voxel behind that face comes, and which
/// one it is. Where two faces are crossed so close together that rounding decides which comes first, or the
/// ray ends so close behind a face that rounding decides whether it gets there, the ray is walked. O(voxels),
/// about 4 ns each. Throws std::bad_alloc.
void list_ray_keys(const Ray& ray, std::vector<VoxelKey>& keys);

}  // namespace octoskin
