// The space that the robot itself takes: no sensor sees into it, and no obstacle is there.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>

#include "host/core/kinematics/capsule.hpp"
#include "host/core/mapping/fused_map.hpp"

namespace octoskin {

/// So many voxels the boxes about the capsules may have in all: some 2 s. An arm of seven capsules and a
/// margin of 0.3 m have 5 million at 1 cm.
inline constexpr std::uint64_t kOwnSpaceVoxelsMax = std::uint64_t{1} << 27U;

/// What the robot itself takes, in the map frame, finite (else nothing is freed).
struct OwnBody {
    std::span<const PosedCapsule> around;  ///< as it is asked about: with padding, and wider than its links
    std::span<const PosedCapsule>
        certain;  ///< RobotQueryConfig::is_of_certain_body: nothing else can be there
};

/// Frees each unknown voxel whose centre is within `margin_m` of the surface of `body.around`, and confirms
/// each stale free one; frees each occupied voxel that lies wholly within one capsule of `body.certain`, and
/// no other: an obstacle may be where a capsule is wider than the link, and in the part of a voxel that is
/// beside it. Returns how many there were. `map` is a copy to ask, not the map that goes on. What there is no
/// room for stays unknown. A caller that gives a margin says that nothing is hidden in it; a capsule that is
/// wider than its link hides what is between the two, too. Empty: there are more voxels than
/// kOwnSpaceVoxelsMax, and nothing was done; or `is_ending`, which is asked at each layer of bricks, has said
/// so. O(voxels of the capsules' boxes), 10 ns each. Throws std::bad_alloc.
std::optional<std::size_t> free_own_space(
    FusedMap& map, const OwnBody& body, double margin_m,
    const std::function<bool()>& is_ending = [] { return false; });

}  // namespace octoskin
