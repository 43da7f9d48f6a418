// The space that the robot itself takes: no sensor sees into it, and no obstacle is there.
#pragma once

#include <cstddef>
#include <span>

#include "host/core/kinematics/capsule.hpp"
#include "host/core/mapping/fused_map.hpp"

namespace octoskin {

/// Frees each voxel whose centre lies in one of the capsules, and each unknown one whose centre is within
/// `margin_m` of a capsule's surface; returns how many were not free. Free voxels there
/// that are stale are confirmed, and counted, too. `map` is a copy to ask, not the map
/// that goes on. What is occupied outside the capsules stays so, and what there is no room for stays unknown.
/// `capsules`: of the robot as it stands, without padding, in the map frame, finite (else nothing is freed).
/// Whoever gives a margin says that nothing is hidden in it; a capsule that is wider than its link hides what
/// is between the two, too. O(voxels of the capsules' boxes), 10 ns each.
std::size_t free_own_space(FusedMap& map, std::span<const PosedCapsule> capsules, double margin_m);

}  // namespace octoskin
