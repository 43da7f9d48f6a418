#include "host/io/rig/host_rig_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <utility>

#include "host/core/kinematics/joint_history.hpp"
#include "host/io/rig/zone_optics.hpp"
#include "hw/rigfile/joined.hpp"
#include "hw/rigfile/links_without_body.hpp"
#include "hw/rigfile/reflex.hpp"
#include "hw/rigfile/robot_description.hpp"
#include "hw/rigfile/zone.hpp"

namespace octoskin {
namespace {

HostSensor to_host(const rig::Sensor& sensor, const SensorConfig& config) {
    HostSensor host;
    host.name = sensor.name;
    host.link = sensor.link;
    host.T_link_sensor = sensor.T_link_sensor;
    host.timing_budget = std::chrono::milliseconds(config.timing_budget_ms);
    host.period = std::chrono::milliseconds(config.inter_measurement_ms);
    host.zones.clear();
    for (std::size_t i = 0; i < config.zone_count; ++i) {
        host.zones.push_back({sensor.zone_offset_m[i], rig::zone_direction(config.zones[i]),
                              beam_optics(sensor, config.zones[i])});
    }
    host.fov_rad =
        2.0 *
        (config.zone_count == 1 ? host.zones.front().optics : beam_optics(sensor, Roi{})).half_angle_rad;
    host.reflex_below_m = 1e-3 * config.reflex_below_mm;
    return host;
}

HostNode to_host(const rig::Node& node) {
    HostNode host;
    host.node_id = node.config.node_id;
    host.name = node.name;
    host.node_hash = node_hash(node.config);
    host.pinned_build_id = node.pinned_build_id;
    host.aux_every =
        node.config.uses_can_fd ? std::uint8_t{0} : node.config.aux_every;  // on classical CAN only
    for (std::size_t i = 0; i < node.sensors.size(); ++i) {
        host.sensors.push_back(to_host(node.sensors[i], node.config.sensors[i]));
    }
    return host;
}

HostRangeLimits to_host(const rig::RangeLimits& limits) {
    return {.min_m = limits.min_m,
            .max_m = limits.max_m,
            .sigma_max_m = limits.sigma_max_m,
            .time_uncertainty_max = Nanoseconds{std::llround(1e6 * limits.time_uncertainty_max_ms)}};
}

HostRig to_host(const rig::Rig& rig) {
    HostRig host;
    host.name = rig.name;
    host.rig_hash = rig::rig_hash(rig);
    host.T_map_base = rig.T_map_base;
    for (const rig::Node& node : rig.nodes) host.nodes.push_back(to_host(node));
    for (const rig::JointSource& source : rig.joint_sources)
        host.joint_sources.push_back(
            {source.node_id, source.joints, source.rate_hz, source.way == rig::JointWay::socket});
    host.bit_rates = {.nominal = rig.bus.nominal_bitrate, .data = rig.bus.data_bitrate};
    for (const rig::Camera& camera : rig.cameras) host.cameras.push_back(host_camera(camera));
    host.links_ignored_by_sensors = rig.links_ignored_by_sensors;
    host.depth_self_margin_m = rig.depth_self_margin_m;
    host.range_self_margin_m = rig.range_self_margin_m;
    host.range_limits = to_host(rig.range_limits);
    return host;
}

/// The warning about links that the rig does not list; empty if it lists all of them.
std::string warning_of(const std::vector<LinkWithoutBody>& links) {
    std::vector<std::string> names;
    for (const LinkWithoutBody& link : links) {
        if (!link.is_listed) names.push_back(link.link);
    }
    if (names.empty()) return {};
    return rig::joined(names) + (names.size() == 1 ? ": this link moves, has" : ": these links move, have") +
           " a <visual> and no body that covers it, and no link fixed to it has one: it comes into the map "
           "as the world "
           "does, and a query answers unknown instead of free. Give it capsules (docs/how-to/own-robot.md), "
           "or list it in robot.links_without_body of the rig";
}

/// A warning if one lost sample leaves a gap that is not bridged; otherwise empty.
std::string rate_warning(double rate_hz) {
    const double bridged_s = std::chrono::duration<double>(JointHistoryConfig{}.bracket_max).count();
    const double wanted_hz = 2.0 / bridged_s;
    if (rate_hz >= wanted_hz) return {};
    return fmt::format(
        "joints.rate_hz {:g}: at most {:g} ms between two joint samples are bridged: measurements about a "
        "lost or late sample have no pose (joints_missing). Send joint states {:g} times a second or more, "
        "and write that rate there",
        rate_hz, bridged_s * 1e3, wanted_hz);
}

std::vector<std::string> notes_of(const std::vector<LinkWithBorrowedBody>& links) {
    std::vector<std::string> notes;
    for (const LinkWithBorrowedBody& link : links) {
        notes.push_back(link.link + ": this link moves, has a <visual> and no body of its own; the body of " +
                        link.body_of + ", which is fixed to it, is used instead. Check that it covers both");
    }
    return notes;
}

}  // namespace

static_assert(rig::kCamerasMax == kCamerasMax);

HostCamera host_camera(const rig::Camera& camera) {
    HostCamera host;
    host.name = camera.name;
    host.intrinsics = {camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy, camera.lens};
    host.depth_min_m = camera.depth_min_m;
    host.depth_max_m = camera.depth_max_m;
    host.link = camera.link;
    host.T_link_camera = camera.T_link_camera;
    host.rate_hz = camera.rate_hz;
    if (const auto& noise = camera.noise)
        host.noise = DepthNoiseLaw{.constant_m = noise->noise_m,
                                   .quadratic_per_m = noise->noise_per_m,
                                   .from_m = noise->noise_from_m,
                                   .bias_per_m = noise->bias_per_m};
    host.device = camera.device;
    return host;
}

Result<HostSetup, Error> make_host_setup(const rig::Rig& rig) {
    auto robot = read_robot_model(rig.urdf, rig.base_link, rig.joint_names());
    if (!robot) return unexpected(robot.error());
    auto frames = read_robot_frames(rig.urdf, rig.base_link);
    if (!frames) return unexpected(frames.error());
    const auto capsules = rig::padded_body(rig);
    if (!capsules) return unexpected(capsules.error());
    HostRig host = to_host(rig);
    for (const rig::Capsule& capsule : *capsules) {
        if (!robot->find_link(capsule.link)) {
            return unexpected(Error{
                .code = ErrorCode::conflict,
                .what = "has a <collision> but is not below the rig's base link '" + rig.base_link + "'",
                .remedy = "remove it, or use another base_link",
                .file = rig.urdf.shown(),
                .key = "link " + capsule.link});
        }
        host.body.push_back({capsule.link, capsule.p_link_a, capsule.p_link_b, capsule.radius_m});
    }
    const auto certain = rig::certain_body(rig);
    if (!certain) return unexpected(certain.error());
    for (const rig::Capsule& capsule : *certain)
        host.certain_body.push_back({capsule.link, capsule.p_link_a, capsule.p_link_b, capsule.radius_m});
    const auto bodyless = rig::bodyless_links(rig, *capsules);
    if (!bodyless) return unexpected(bodyless.error());
    for (const std::string& link : bodyless->without_body) {
        const bool is_listed =
            std::ranges::find(rig.links_without_body, link) != rig.links_without_body.end();
        host.links_without_body.push_back({link, is_listed});
    }
    for (const rig::BorrowedBody& borrowed : bodyless->borrowed)
        host.links_with_borrowed_body.push_back({borrowed.link, borrowed.body_of});
    std::vector<std::string> notes = notes_of(host.links_with_borrowed_body);
    std::vector<std::string> warnings = rig::reflex_warnings(rig);
    if (host.body.empty()) {
        warnings.push_back("no link at or below " + rig.base_link +
                           " has a <collision>: the robot is not removed from images and ranges");
    }
    if (auto warning = warning_of(host.links_without_body); !warning.empty())
        warnings.push_back(std::move(warning));
    for (const rig::JointSource& source : rig.joint_sources)
        if (auto warning = rate_warning(source.rate_hz); !warning.empty())
            warnings.push_back(std::move(warning));
    return HostSetup{std::move(host), std::move(robot).value(), std::move(warnings), std::move(notes),
                     std::move(frames).value()};
}

}  // namespace octoskin
