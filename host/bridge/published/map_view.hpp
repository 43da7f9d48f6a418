// The map as it is published: without what a planner models itself, and with unknown space as obstacles.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <span>

#include "host/bridge/published/solid.hpp"
#include "host/core/kinematics/capsule.hpp"
#include "host/core/mapping/fused_map.hpp"

namespace octoskin::bridge {

/// A copy in which the occupied voxels that come within `padding_m` of a solid are unknown. Work is counted
/// in shapes or triangles compared with voxels, for all solids together. Solids beyond `work_max` are left in
/// the map, the last one in part, and counted.
struct CutMap {
    FusedMap map;
    std::size_t solids_left_in = 0;
};
inline constexpr std::uint64_t kSolidWorkMax = 2'000'000;  ///< about 50 ms
[[nodiscard]] CutMap without(const FusedMap& map, std::span<const Solid> solids, double padding_m,
                             std::uint64_t work_max = kSolidWorkMax);

/// A copy in which the unknown voxels with their centre in `box_map` are occupied, but for those with their
/// centre within `own_space_m` of the robot's body: there a sensor on the robot sees nothing. `body_map`: in
/// the map frame. The box may have up to kUnknownVoxelsMax voxels (asserted; see `voxels_in`).
inline constexpr double kUnknownVoxelsMax = 20e6;
[[nodiscard]] FusedMap with_unknown_occupied(const FusedMap& map, const Eigen::AlignedBox3d& box_map,
                                             std::span<const PosedCapsule> body_map, double own_space_m);
[[nodiscard]] double voxels_in(const Eigen::AlignedBox3d& box_map, double resolution_m) noexcept;

}  // namespace octoskin::bridge
