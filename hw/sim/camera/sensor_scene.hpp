// What a simulated range sensor on the moving arm sees: the nearest of the world and the robot's own body.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "hw/rigfile/rig.hpp"
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
    /// The world as it is at an instant, in place of `world`; empty: nothing in that moves.
    std::function<const World&(SimTime)> world_at{};

    [[nodiscard]] const World& at(SimTime time) const { return world_at ? world_at(time) : world; }
};

/// One sensor: where it is, and the number that keeps its noise apart from the others'.
struct SensorMount {
    std::string link;
    Eigen::Isometry3d T_link_sensor =
        Eigen::Isometry3d::Identity();  ///< ranges run along +z (or the zone's beam)
    std::uint32_t noise_id = 0;
    std::optional<rig::Cone> cone{};  ///< none: one ideal ray
};

/// Of a sensor that sees a cone: what a signal is in counts, so that the device's default limit of 1 Mcps
/// lies where half of the ranges fail, at 0.05.
inline constexpr double kConeMcpsPerSignal = 20.0;
/// And how it spreads: the scale of the logistic distribution of what is measured of it, by the
/// whole array.
inline constexpr double kConeSignalSpread = 0.01;
/// Deviation of a range by its signal.
[[nodiscard]] double cone_sigma_m(double signal) noexcept;

/// The scene of one sensor, for the simulated device, from where the arm is at the middle of the ranging
/// window. The link must exist (asserted).
///
/// Without a cone: one ideal ray along the middle of the zone's beam. Nothing within the optics' limits: an
/// empty return. Otherwise the range plus Gaussian noise, with a signal that passes any limit: how far the
/// sensor sees is set by the optics here and not by the signal. About 5 us a call.
///
/// With one: sub-rays, each ending at the nearest of world and robot, and of their echoes the nearest peak
/// (cone_view.hpp), within the optics' limits. Its range has Gaussian noise of cone_sigma_m(), its signal
/// logistic noise of its own; whether it is too weak or too uncertain, the device judges. About 80 us a call
/// with 16 x 16 sub-rays.
///
/// Noise is a function of (seed, noise_id, ranging index).
[[nodiscard]] RangingScene ranging_scene(const SensorSurroundings& surroundings, const SensorMount& mount);

}  // namespace octoskin::sim
