#include "hw/sim/camera/sensor_scene.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "hw/rigfile/zone.hpp"
#include "hw/sim/camera/cone_view.hpp"
#include "hw/sim/noise/noise.hpp"
#include "hw/sim/vl53l1x/ranging_result.hpp"

namespace octoskin::sim {
namespace {

constexpr double kAmbient_mcps = 0.05;  ///< of the whole array
constexpr double kArraySpads = 256.0;

/// The share of its signal that a zone counts. By the datasheet (DS12385 rev 7, table 9) a zone of 4 x 4
/// SPADs sees a dark target, grey of 17 %, up to 45 cm: with a third of the signal that it needs for brighter
/// targets further away. No law of signal and SPADs gives this, so the share is fitted: 1 from 8 x 8 SPADs or
/// grey of 50 % on, and below that less in proportion to the logarithms of both.
double counted_share(const Roi& zone, double reflectivity) {
    constexpr double kSmall = 4.0 * 4.0, kLarge = 8.0 * 8.0;  // SPADs
    constexpr double kDark = 0.17, kGrey = 0.5;
    constexpr double kOfSmallAndDark = 0.36;
    const double smallness = std::log(kLarge / (zone.width * zone.height)) / std::log(kLarge / kSmall);
    const double darkness = std::log(kGrey / reflectivity) / std::log(kGrey / kDark);
    return std::pow(kOfSmallAndDark, std::clamp(smallness, 0.0, 1.0) * std::clamp(darkness, 0.0, 1.0));
}

/// One ideal ray along the middle of the zone's beam.
struct RayScene {
    SensorSurroundings surroundings;
    SensorMount mount;
    Noise noise;

    RangingReturn operator()(std::uint32_t ranging_index, SimTime window_middle, const Roi& roi) const {
        /// Far above the default limit of 1 Mcps; a grey wall at 1 m returns this in the dark.
        constexpr double kSignal_mcps = 8.0;
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
        auto nearest = surroundings.body.at(poses, surroundings.ignored_links)
                           .cast(origin, direction, surroundings.optics.max_m);
        const auto hit = surroundings.at(time).cast(origin, direction, surroundings.optics.max_m);
        if (hit && (!nearest || hit->range_m < *nearest)) {
            nearest = hit->range_m;
        }
        return nearest && *nearest <= surroundings.optics.max_m ? nearest : std::nullopt;
    }
};

/// Where a sensor and the robot are at one instant.
struct Instant {
    Eigen::Isometry3d T_base_sensor;
    PosedBody body;  ///< the parts of the robot that the sensor may see
};

Instant instant_of(const SensorSurroundings& surroundings, const SensorMount& mount, SimTime time) {
    const auto poses = surroundings.arm.forward(surroundings.trajectory.at(time));
    return {poses.at(mount.link) * mount.T_link_sensor,
            surroundings.body.at(poses, surroundings.ignored_links)};
}

/// A cone of sub-rays.
struct ConeScene {
    SensorSurroundings surroundings;
    SensorMount mount;
    ConeView view;
    double half_angle_rad;
    Noise range_noise;
    Noise signal_noise;

    RangingReturn operator()(std::uint32_t ranging_index, SimTime window_middle, const Roi& roi) const {
        auto echoes = echoes_of(window_middle, roi);
        const auto peak = nearest_peak(echoes);
        const double signal = peak ? peak->signal : 0.0;
        RangingReturn seen;
        seen.sigma_m = cone_sigma_m(signal);
        seen.peak_signal_mcps =
            measured_signal(signal, kConeSignalSpread * signal_limit_share(roi), ranging_index) *
            kConeMcpsPerSignal;
        seen.ambient_mcps = kAmbient_mcps * roi.width * roi.height / kArraySpads;
        if (peak && peak->range_m >= surroundings.optics.min_m) {
            seen.range_m = std::max(0.0, peak->range_m + seen.sigma_m * range_noise.gaussian(ranging_index));
        }
        return seen;
    }

    /// The measured signal has logistic noise. The device compares it with its limit, so the probability of a
    /// refused range is a logistic curve about that limit.
    [[nodiscard]] double measured_signal(double signal, double spread, std::uint32_t ranging_index) const {
        const double uniform = signal_noise.uniform(ranging_index);
        return std::max(0.0, signal + spread * std::log(uniform / (1.0 - uniform)));
    }

    [[nodiscard]] std::vector<Echo> echoes_of(SimTime time, const Roi& roi) const {
        const Instant instant = instant_of(surroundings, mount, time);
        const Eigen::Vector3d origin = instant.T_base_sensor.translation();
        std::vector<Eigen::Vector3d> directions;
        for (const Eigen::Vector3d& direction_sensor : view.directions_sensor())
            directions.emplace_back(instant.T_base_sensor.linear() * direction_sensor);
        std::vector<RayHit> hits(directions.size());
        surroundings.at(time).cast_fan(origin, directions, surroundings.optics.max_m, hits);
        hide_behind_body(instant, directions, hits);
        const std::vector<double> weights = view.weights(roi);
        const double reflectivity = surroundings.optics.reflectivity;
        const double counted = counted_share(roi, reflectivity);
        std::vector<Echo> echoes;
        for (std::size_t i = 0; i < hits.size(); ++i) {
            if (!(hits[i].range_m <= surroundings.optics.max_m)) continue;
            const double cos_incidence = std::abs(hits[i].normal.dot(directions[i]));
            echoes.push_back({hits[i].range_m, echo_signal(weights[i] * counted, reflectivity, cos_incidence,
                                                           hits[i].range_m)});
        }
        return echoes;
    }

    /// Ends sub-rays at the robot if they meet it first.
    void hide_behind_body(const Instant& instant, const std::vector<Eigen::Vector3d>& directions,
                          std::vector<RayHit>& hits) const {
        const Eigen::Vector3d origin = instant.T_base_sensor.translation();
        for (const BodyCapsule& capsule : instant.body.capsules) {
            const Eigen::Vector3d middle = 0.5 * (capsule.p_base_a + capsule.p_base_b);
            const double half_length = 0.5 * (capsule.p_base_b - capsule.p_base_a).norm();
            if (!may_see(instant.T_base_sensor, middle, half_length + capsule.radius_m)) continue;
            for (std::size_t i = 0; i < hits.size(); ++i) {
                const auto t = cast_capsule(capsule, origin, directions[i]);
                if (!t || *t >= hits[i].range_m) continue;
                hits[i].range_m = *t;
                hits[i].normal = outward_normal(capsule, origin + *t * directions[i]);
            }
        }
        std::vector<TriangleHit> mesh_hits(directions.size());
        for (const PosedMesh& mesh : instant.body.meshes) {
            if (!may_see(instant.T_base_sensor, mesh.p_middle(), mesh.mesh->radius_m())) continue;
            mesh.cast_fan(origin, directions, surroundings.optics.max_m, mesh_hits);
            for (std::size_t i = 0; i < hits.size(); ++i) {
                if (!(mesh_hits[i].t < hits[i].range_m)) continue;
                hits[i].range_m = mesh_hits[i].t;
                hits[i].normal = mesh_hits[i].normal;
            }
        }
    }

    /// False only if the ball lies outside the cone.
    [[nodiscard]] bool may_see(const Eigen::Isometry3d& T_base_sensor, const Eigen::Vector3d& p_base_middle,
                               double radius) const {
        const Eigen::Vector3d to_middle = p_base_middle - T_base_sensor.translation();
        const double distance = to_middle.norm();
        if (distance <= radius) return true;
        const double cos_middle = T_base_sensor.linear().col(2).dot(to_middle) / distance;
        return std::acos(std::clamp(cos_middle, -1.0, 1.0)) <= half_angle_rad + std::asin(radius / distance);
    }
};

}  // namespace

double cone_sigma_m(double signal) noexcept {
    constexpr double kFloor_m = 0.01;
    constexpr double kAtUnitSignal_m = 0.006;
    constexpr double kLeastSignal = 1e-6;  // gives 6 m, which any limit refuses
    return kFloor_m + kAtUnitSignal_m / std::sqrt(std::max(signal, kLeastSignal));
}

RangingScene ranging_scene(const SensorSurroundings& surroundings, const SensorMount& mount) {
    assert(surroundings.arm.has_link(mount.link));
    const Noise range_noise = Noise(surroundings.seed, NoiseSource::range).of(mount.noise_id);
    if (!mount.cone) return RayScene{surroundings, mount, range_noise};
    const double half_angle = mount.cone->half_angle_deg * std::numbers::pi / 180.0;
    return ConeScene{surroundings,          mount,
                     ConeView(*mount.cone), half_angle,
                     range_noise,           Noise(surroundings.seed, NoiseSource::signal).of(mount.noise_id)};
}

}  // namespace octoskin::sim
