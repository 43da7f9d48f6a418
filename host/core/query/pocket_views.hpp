// How the arm would have to stand so that one of its sensors looks into an unknown pocket.
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
    std::size_t postures = 3000;  ///< that are tried
    std::size_t pockets = 10;     ///< the largest so many are looked for
    std::uint32_t seed = 1;       ///< the same seed, the same postures, on this machine
    double near_spread = 0.4;     ///< standard deviation of half of the postures about `from`, rad or m
};

/// For each of the largest pockets, of the postures tried in which the axis of a sensor, or of one of its
/// zones, meets the pocket's border within the rig's range with nothing but free voxels before it: a free one
/// or, if there is none, one in which the arm touches unknown voxels but no occupied one; of several the one
/// nearest to `from`. Half of them are tried about `from`, the others all over the limits; empty if none will
/// do. A view does not say that the way there is free: ask for the leg. `from`: as RobotQuery's (asserted to
/// be as many as joints). About 30 us a posture; `is_ending` is asked before each, and true ends the search
/// with what was found.
[[nodiscard]] std::vector<std::optional<PocketView>> find_views(
    const HostRig& rig, const RobotQuery& robot, const FusedMap& map, const UnknownPockets& pockets,
    std::span<const double> from, const PocketViewConfig& config = {},
    const std::function<bool()>& is_ending = [] { return false; });

}  // namespace octoskin
