// Searches for arm postures in which a sensor looks into an unknown pocket.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/core/mapping/fused_map.hpp"
#include "host/core/query/robot_query.hpp"
#include "host/core/query/unknown_pockets.hpp"
#include "host/core/rig/host_rig.hpp"

namespace octoskin {

struct PocketView {
    std::vector<double> position;             ///< joints, rad or m
    PostureState state = PostureState::free;  ///< of the arm there; never occupied
    std::string sensor;                       ///< by name
    double range_m = 0.0;                     ///< from the sensor to the border's voxel, along its axis
    double joint_change_max = 0.0;            ///< the largest of any joint
};

struct PocketViewConfig {
    std::size_t postures = 3000;  ///< number of postures tried
    std::size_t pockets = 10;     ///< number of the largest pockets that are searched for
    std::uint32_t seed = 1;       ///< the same seed gives the same postures, on this machine
    FreeDemand demand = {};
    double near_spread = 0.4;  ///< standard deviation of half of the postures about `from`, rad or m
};

/// Searches a view for each of the largest pockets. A view is a posture in which the axis of a sensor, or of
/// one of its zones, meets the pocket's border within the rig's range, with only free voxels before it. A
/// free posture is preferred; otherwise one in which the arm touches unknown voxels but no occupied one. Of
/// several the one nearest to `from` is taken; empty if none is suitable. Half of the postures are near
/// `from`, the others are spread over the limits.
///
/// A view does not imply that the way to it is free: query the leg. `from`: as for RobotQuery, one value per
/// joint (asserted). About 30 us per posture. `is_ending` is called before each one; true ends the search
/// with the views found so far.
[[nodiscard]] std::vector<std::optional<PocketView>> find_views(
    const HostRig& rig, const RobotQuery& robot, const FusedMap& map, const UnknownPockets& pockets,
    std::span<const double> from, const PocketViewConfig& config = {},
    const std::function<bool()>& is_ending = [] { return false; });

}  // namespace octoskin
