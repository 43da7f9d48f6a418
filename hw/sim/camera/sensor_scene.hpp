// What a simulated range sensor on the moving arm sees: the nearest of the world and the robot's own body.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <vector>

#include "hw/rigfile/robot_description.hpp"
#include "hw/sim/arm/arm.hpp"
#include "hw/sim/arm/trajectory.hpp"
#include "hw/sim/scenario/scenario.hpp"
#include "hw/sim/vl53l1x/scene.hpp"
#include "hw/sim/world/world.hpp"

namespace octoskin::sim {

/// All that the sensors of one simulation share. Whoever makes a scene keeps these alive as long as the
/// scene.
struct SensorSurroundings {
    const World& world;
    const Arm& arm;
    const Trajectory& trajectory;
    const std::vector<rig::Capsule>& capsules;
    /// Links that no sensor sees (their own mount). They must be those that the rig ignores when it predicts
    /// self-hits.
    std::vector<std::string> ignored_links;
    RangeOptics optics;
    std::uint64_t seed = 0;
};

/// One sensor: where it is, and the number that keeps its noise apart from the others'.
struct SensorMount {
    std::string link;
    Eigen::Isometry3d T_link_sensor =
        Eigen::Isometry3d::Identity();  ///< ranges run along +z (or the zone's beam)
    std::uint32_t noise_id = 0;
};

/// The scene of one sensor, for the simulated device: one ideal ray along the middle of the zone's beam, from
/// where the arm is at the middle of the ranging window. Nothing within the optics' limits: an empty return.
/// Otherwise the range plus Gaussian noise, a function of (seed, noise_id, ranging index), with a signal that
/// passes any limit: how far the sensor sees is set by the optics here and not by the signal. The link must
/// exist (asserted). About 5 us a call.
[[nodiscard]] RangingScene ranging_scene(const SensorSurroundings& surroundings, const SensorMount& mount);

}  // namespace octoskin::sim
