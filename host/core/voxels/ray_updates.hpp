// Lists one term for all voxels that walk_ray_keys() visits, without walking the ray.
#pragma once

#include <span>
#include <vector>

#include "host/core/voxels/ray_walk.hpp"
#include "host/core/voxels/voxel_update.hpp"

namespace octoskin {

/// Writes one update for each voxel that walk_ray_keys() visits, in its order, to the beginning of `buffer`.
/// The buffer grows if needed and always has room for one more update.
///
/// In a walk each step depends on the one before, and its axis cannot be predicted. Therefore this function
/// does not walk. For each face that the ray crosses it computes how many faces of the other two axes the ray
/// has crossed before, several faces at a time. This gives the voxel behind the face and its place in the
/// order. The ray is walked instead if rounding decides which of two faces comes first, or whether the ray
/// reaches a face near its end.
///
/// O(voxels), about 2 ns each. Throws std::bad_alloc.
[[nodiscard]] std::span<VoxelUpdate> list_ray_updates(const Ray& ray, float log_odds,
                                                      std::vector<VoxelUpdate>& buffer);

}  // namespace octoskin
