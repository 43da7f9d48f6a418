// The view of a simulated range sensor on the moving arm: the nearest surface of the world or of the robot's
// own body.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "hw/rigfile/rig.hpp"
#include "hw/sim/arm/arm.hpp"
#include "hw/sim/arm/body.hpp"
#include "hw/sim/arm/trajectory.hpp"
#include "hw/sim/scenario/scenario.hpp"
#include "hw/sim/vl53l1x/scene.hpp"
#include "hw/sim/world/world.hpp"

namespace octoskin::sim {

/// Data shared by the sensors of one simulation. They must outlive the scenes.
struct SensorSurroundings {
    const World& world;
    const Arm& arm;
    const Trajectory& trajectory;
    const Body& body;
    /// Links that no sensor sees (their own mount). They must be the rig's links_ignored_by_sensors.
    std::vector<std::string> ignored_links;
    RangeOptics optics;
    std::uint64_t seed = 0;
    /// The world at an instant, in place of `world`; empty: nothing moves.
    std::function<const World&(SimTime)> world_at{};

    [[nodiscard]] const World& at(SimTime time) const { return world_at ? world_at(time) : world; }
};

/// One sensor: its pose, and the number that makes its noise independent of the others'.
struct SensorMount {
    std::string link;
    Eigen::Isometry3d T_link_sensor =
        Eigen::Isometry3d::Identity();  ///< ranges run along +z (or the zone's beam)
    std::uint32_t noise_id = 0;
    std::optional<rig::Cone> cone{};  ///< none: one ideal ray
};

/// Conversion of a cone's signal to counts, chosen so that half of the ranges fail at a signal of 0.05 with
/// the device's default limit of 1 Mcps.
inline constexpr double kConeMcpsPerSignal = 20.0;
/// Scale of the logistic noise of the measured signal, for the whole array.
inline constexpr double kConeSignalSpread = 0.01;
/// Standard deviation of a range for a signal.
[[nodiscard]] double cone_sigma_m(double signal) noexcept;

/// The scene of one sensor for the simulated device, at the arm's pose in the middle of the ranging window.
/// The link must exist (asserted).
///
/// Without a cone: one ideal ray along the middle of the zone's beam. Without a surface within the optics'
/// limits the return is empty. Otherwise it is the range plus Gaussian noise, with a signal above any limit:
/// the optics' limits set the maximum range, not the signal. About 5 us a call.
///
/// With a cone: sub-rays, each ending at the nearest surface of world or robot, and the nearest peak of their
/// echoes (cone_view.hpp) within the optics' limits. The range has Gaussian noise of cone_sigma_m(), the
/// signal has independent logistic noise. The device model decides whether they pass its limits. About 80 us
/// a call with 16 x 16 sub-rays.
///
/// Noise is a function of (seed, noise_id, ranging index).
[[nodiscard]] RangingScene ranging_scene(const SensorSurroundings& surroundings, const SensorMount& mount);

}  // namespace octoskin::sim
