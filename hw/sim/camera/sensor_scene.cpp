#include "hw/sim/camera/sensor_scene.hpp"

#include <algorithm>
#include <cassert>

#include "hw/rigfile/zone.hpp"
#include "hw/sim/arm/body.hpp"
#include "hw/sim/noise/noise.hpp"

namespace octoskin::sim {
namespace {

/// Far above the default limit of 1 Mcps, and what a grey wall at 1 m returns in the dark.
constexpr double kSignal_mcps = 8.0;
constexpr double kAmbient_mcps = 0.05;

struct Scene {
    SensorSurroundings surroundings;
    SensorMount mount;
    Noise noise;

    RangingReturn operator()(std::uint32_t ranging_index, SimTime window_middle, const Roi& roi) const {
        RangingReturn seen;
        seen.sigma_m = surroundings.optics.sigma_m;
        seen.ambient_mcps = kAmbient_mcps;
        const auto range_m = true_range_m(window_middle, roi);
        if (range_m && *range_m >= surroundings.optics.min_m) {
            seen.range_m =
                std::max(0.0, *range_m + surroundings.optics.sigma_m * noise.gaussian(ranging_index));
            seen.peak_signal_mcps = kSignal_mcps;
        }
        return seen;
    }

    [[nodiscard]] std::optional<double> true_range_m(SimTime time, const Roi& roi) const {
        const auto poses = surroundings.arm.forward(surroundings.trajectory.at(time));
        const Eigen::Isometry3d T_base_sensor = poses.at(mount.link) * mount.T_link_sensor;
        const Eigen::Vector3d origin = T_base_sensor.translation();
        const Eigen::Vector3d direction = T_base_sensor.linear() * rig::zone_direction(roi);
        auto nearest =
            cast_robot(surroundings.capsules, poses, origin, direction, surroundings.ignored_links);
        const auto hit = surroundings.world.cast(origin, direction, surroundings.optics.max_m);
        if (hit && (!nearest || hit->range_m < *nearest)) {
            nearest = hit->range_m;
        }
        return nearest && *nearest <= surroundings.optics.max_m ? nearest : std::nullopt;
    }
};

}  // namespace

RangingScene ranging_scene(const SensorSurroundings& surroundings, const SensorMount& mount) {
    assert(surroundings.arm.has_link(mount.link));
    return Scene{surroundings, mount, Noise(surroundings.seed, NoiseSource::range).of(mount.noise_id)};
}

}  // namespace octoskin::sim
