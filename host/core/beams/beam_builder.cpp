#include "host/core/beams/beam_builder.hpp"

#include <algorithm>
#include <cassert>
#include <limits>

#include "host/core/kinematics/self_hit.hpp"

namespace octoskin {
namespace {

constexpr double kEndless = std::numeric_limits<double>::infinity();

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
            builder.sensors_[{node.node_id, index++}] = {*link, sensor.T_link_sensor, sensor.zones};
        }
    }
    return builder;
}

bool BeamBuilder::has(const BeamSource& source) const {
    const auto found = sensors_.find({source.node_id, source.sensor});
    return found != sensors_.end() && source.zone < found->second.zones.size();
}

Result<Beam, BeamFault> BeamBuilder::place(const RangeMeasurement& measurement,
                                           const RobotPose& robot) const {
    const auto found = sensors_.find({measurement.source.node_id, measurement.source.sensor});
    assert(found != sensors_.end());
    const Sensor& sensor = found->second;
    assert(measurement.source.zone < sensor.zones.size());

    const Eigen::Isometry3d T_base_sensor = robot.T_base_link[sensor.link] * sensor.T_link_sensor;
    const Eigen::Isometry3d T_map_sensor = T_map_base_ * T_base_sensor;
    const Eigen::Vector3d& direction_sensor = sensor.zones[measurement.source.zone].direction_sensor;
    if (!T_map_sensor.matrix().allFinite() || !direction_sensor.allFinite()) {
        return unexpected(BeamFault::not_finite);
    }
    double free_m = kEndless;
    if (rules_.removes_robot) {
        const auto self_hit_m = predict_self_hit(robot.body_base, T_base_sensor.translation(),
                                                 T_base_sensor.linear() * direction_sensor, ignored_links_);
        free_m = self_hit_m.value_or(kEndless) - self_margin_m_;
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
                .clear_limit_m = measurement.range_m ? 0.0 : clear_m};
}

}  // namespace octoskin
