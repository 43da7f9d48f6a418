// The space that the robot itself occupies: no sensor measures it, and no obstacle is there.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>

#include "host/core/kinematics/capsule.hpp"
#include "host/core/mapping/fused_map.hpp"
#include "host/core/query/weakest_free.hpp"

namespace octoskin {

/// Upper limit of the voxels in all boxes around the capsules: about 2 s. An arm of seven capsules with a
/// margin of 0.3 m has 5 million at 1 cm.
inline constexpr std::uint64_t kOwnSpaceVoxelsMax = std::uint64_t{1} << 27U;

/// The robot's body in the map frame, finite (else nothing is freed).
struct OwnBody {
    std::span<const PosedCapsule> around;  ///< the body of queries: with padding, wider than its links
    /// RobotQueryConfig::is_of_certain_body: space that only the robot can occupy.
    std::span<const PosedCapsule> certain;
};

/// Frees each unknown voxel whose centre is within `margin_m` of the surface of `body.around`, and confirms
/// each free one that is stale or does not meet the demand. Frees each occupied voxel that lies completely
/// within one capsule of `body.certain`, and no other: an obstacle may be where a capsule is wider than the
/// link, or in the part of a voxel outside the capsule. Returns the number of these voxels.
///
/// `map` is a copy for queries, not the map that is being built. Voxels for which there is no room stay
/// unknown. With a margin the caller states that nothing is hidden within it; a capsule wider than its link
/// likewise hides the space between the two.
///
/// Empty: there are more voxels than kOwnSpaceVoxelsMax, and nothing was done; or `is_ending`, which is
/// called at each layer of bricks, returned true. O(voxels of the capsules' boxes), 10 ns each. Throws
/// std::bad_alloc.
std::optional<std::size_t> free_own_space(
    FusedMap& map, const OwnBody& body, double margin_m,
    const std::function<bool()>& is_ending = [] { return false; }, const FreeDemand& demand = {});

}  // namespace octoskin
