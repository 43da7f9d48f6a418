// A planner's questions in the furnished room: where is this arm?
#pragma once

#include <octomap/octomap.h>
#include <Eigen/Geometry>

#include <filesystem>
#include <span>
#include <vector>

#include "host/core/kinematics/capsule.hpp"
#include "host/core/query/capsule_query.hpp"

namespace octoskin::bench {

/// The seven moving capsules of one posture, in the map frame.
using ArmCapsules = std::vector<PosedCapsule>;

/// 100 postures of the rig's Panda, as if it stood at `T_map_arm`: about its ready posture, by up to 0.8 rad
/// each joint. Throws std::runtime_error if the rig cannot be read.
[[nodiscard]] std::vector<ArmCapsules> postures_of_arm(const std::filesystem::path& rig,
                                                       const Eigen::Isometry3d& T_map_arm);

/// As users of OctoMap ask: every voxel of the capsule's box by search(), and for those that are not free
/// whether the capsule touches them. The worst of all, occupied, then unknown, then free; and the nearest of
/// that.
[[nodiscard]] CapsuleAnswer worst_in(const octomap::OcTree& tree, const PosedCapsule& capsule);

}  // namespace octoskin::bench
