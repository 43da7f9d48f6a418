#include "host/core/beams/beam_builder.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

#include "host/core/kinematics/self_hit.hpp"
#include "host/core/kinematics/turned_z.hpp"

namespace octoskin {
namespace {

constexpr std::size_t kRaysMax = 19;
constexpr double kEndless = std::numeric_limits<double>::infinity();

/// The direction of a zone. A cone has 18 more rays: 6 at half of its half angle and 12 just within its edge.
std::vector<Eigen::Vector3d> rays_of(const HostZone& zone) {
    std::vector<Eigen::Vector3d> rays = {zone.direction_sensor};
    if (!zone.optics.is_cone() || !zone.direction_sensor.allFinite()) return rays;
    const Eigen::Matrix3d R_sensor_zone = turned_z(zone.direction_sensor.normalized());
    constexpr double kJustWithin = 0.95;
    for (const auto& [count, share] : {std::pair{6, 0.5}, {12, kJustWithin}}) {
        const double angle = share * zone.optics.half_angle_rad;
        for (int i = 0; i < count; ++i) {
            const double turn = 2.0 * std::numbers::pi * i / count;
            rays.emplace_back(R_sensor_zone * Eigen::Vector3d(std::sin(angle) * std::cos(turn),
                                                              std::sin(angle) * std::sin(turn),
                                                              std::cos(angle)));
        }
    }
    return rays;
}

RobotModelFault no_such_link(const std::string& name) {
    return {RobotModelError::unreachable, name};
}

}  // namespace

Result<BeamBuilder, RobotModelFault> BeamBuilder::build(const HostRig& rig, const RobotModel& robot,
                                                        const BeamRules& rules) {
    BeamBuilder builder;
    builder.rules_ = rules;
    builder.self_margin_m_ = rig.range_self_margin_m;
    builder.T_map_base_ = rig.T_map_base;
    for (const std::string& name : rig.links_ignored_by_sensors) {
        const auto link = robot.find_link(name);
        if (!link) {
            return unexpected(no_such_link(name));
        }
        builder.ignored_links_.push_back(*link);
    }
    for (const HostNode& node : rig.nodes) {
        std::uint8_t index = 0;
        for (const HostSensor& sensor : node.sensors) {
            const auto link = robot.find_link(sensor.link);
            if (!link) {
                return unexpected(no_such_link(sensor.link));
            }
            Sensor& placed = builder.sensors_[{node.node_id, index++}];
            placed = {*link, robot.joints_above(*link), sensor.T_link_sensor, {}};
            for (HostZone zone : sensor.zones) {
                if (!rules.sees_cones) zone.optics = {};
                placed.zones.push_back({zone, rays_of(zone)});
            }
        }
    }
    return builder;
}

const BeamOptics* BeamBuilder::optics_of(const BeamSource& source) const {
    const auto found = sensors_.find(source.sensor_id());
    const bool has_zone = found != sensors_.end() && source.zone < found->second.zones.size();
    return has_zone ? &found->second.zones[source.zone].zone.optics : nullptr;
}

std::optional<double> BeamBuilder::self_hit(const Zone& zone, const Eigen::Isometry3d& T_base_sensor,
                                            const RobotPose& robot) const {
    std::array<Eigen::Vector3d, kRaysMax> rays_base;
    for (std::size_t i = 0; i < zone.rays.size(); ++i) rays_base[i] = T_base_sensor.linear() * zone.rays[i];
    return predict_self_hit(robot.body_base, T_base_sensor.translation(),
                            std::span(rays_base).first(zone.rays.size()), zone.zone.optics.half_angle_rad,
                            ignored_links_);
}

Result<Beam, BeamFault> BeamBuilder::place(const RangeMeasurement& measurement,
                                           const RobotPose& robot) const {
    const auto found = sensors_.find(measurement.source.sensor_id());
    assert(found != sensors_.end());
    const Sensor& sensor = found->second;
    assert(measurement.source.zone < sensor.zones.size());
    if ((sensor.joints_above & robot.unknown) != 0) return unexpected(BeamFault::unplaced);

    const Eigen::Isometry3d T_base_sensor = robot.T_base_link[sensor.link] * sensor.T_link_sensor;
    const Eigen::Isometry3d T_map_sensor = T_map_base_ * T_base_sensor;
    const Zone& zone = sensor.zones[measurement.source.zone];
    const Eigen::Vector3d& direction_sensor = zone.zone.direction_sensor;
    if (!T_map_sensor.matrix().allFinite() || !direction_sensor.allFinite()) {
        return unexpected(BeamFault::not_finite);
    }
    double free_m = kEndless;
    if (rules_.removes_robot) {
        free_m = self_hit(zone, T_base_sensor, robot).value_or(kEndless) - self_margin_m_;
    }
    const double clear_m = std::min(rules_.no_return_clear_m, free_m);
    if (measurement.range_m ? *measurement.range_m > free_m : clear_m <= 0.0) {
        return unexpected(BeamFault::self_hit);
    }
    return Beam{.source = measurement.source,
                .captured = measurement.captured,
                .p_map_sensor = T_map_sensor.translation(),
                .direction_map = T_map_sensor.linear() * direction_sensor,
                .range_m = measurement.range_m,
                .sigma_m = measurement.sigma_m,
                .clear_limit_m = measurement.range_m ? 0.0 : clear_m,
                .optics = zone.zone.optics,
                .R_map_sensor = T_map_sensor.linear()};
}

Eigen::Isometry3d BeamBuilder::T_map_sensor(const BeamSource& source, const RobotPose& robot) const {
    const auto found = sensors_.find(source.sensor_id());
    assert(found != sensors_.end());
    return T_map_base_ * robot.T_base_link[found->second.link] * found->second.T_link_sensor;
}

JointTwists BeamBuilder::twists_map(const BeamSource& source, const RobotPose& robot,
                                    const RobotModel& robot_model) const {
    const auto found = sensors_.find(source.sensor_id());
    assert(found != sensors_.end());
    JointTwists twists;
    robot_model.twists(found->second.link, robot.T_base_link, twists);
    return placed(T_map_base_, twists);
}

}  // namespace octoskin
