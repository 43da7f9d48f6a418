#include "host/bridge/robot/robot_facts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <exception>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace octoskin::bridge {
namespace {

using Json = nlohmann::ordered_json;

Eigen::Isometry3d pose_of(const Json& pose) {
    const auto p = pose.at("p").get<std::array<double, 3>>();
    const auto q = pose.at("q").get<std::array<double, 4>>();
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() = Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized().toRotationMatrix();
    T.translation() = Eigen::Vector3d(p[0], p[1], p[2]);
    return T;
}

SensorFacts sensor_of(const Json& sensor) {
    return {.node = sensor.at("node").get<std::uint8_t>(),
            .sensor = sensor.at("sensor").get<std::uint8_t>(),
            .link = sensor.at("link").get<std::string>(),
            .T_link_sensor = pose_of(sensor.at("T_link_sensor")),
            .fov_rad = sensor.at("fov_rad").get<double>(),
            .range_min_m = sensor.at("range_min_m").get<double>(),
            .range_max_m = sensor.at("range_max_m").get<double>()};
}

JointSourceFacts source_of(const Json& source) {
    return {.is_local = source.at("via").get<std::string>() == "socket",
            .joints = source.at("joints").get<std::vector<std::string>>()};
}

CameraFacts camera_of(const Json& camera) {
    return {.name = camera.at("name").get<std::string>(),
            .device = camera.at("device").get<std::string>(),
            .link = camera.at("link").get<std::string>(),
            .T_link_camera = pose_of(camera.at("T_link_camera")),
            .intrinsics = {.width = camera.at("width").get<std::uint32_t>(),
                           .height = camera.at("height").get<std::uint32_t>(),
                           .fx = camera.at("fx").get<double>(),
                           .fy = camera.at("fy").get<double>(),
                           .cx = camera.at("cx").get<double>(),
                           .cy = camera.at("cy").get<double>()},
            .rate_hz = camera.at("rate_hz").get<double>()};
}

Eigen::Vector3d vector_of(const Json& vector) {
    const auto v = vector.get<std::array<double, 3>>();
    return {v[0], v[1], v[2]};
}

JointKind kind_of(const std::string& kind) {
    if (kind == "revolute") return JointKind::revolute;
    if (kind == "continuous") return JointKind::continuous;
    return kind == "prismatic" ? JointKind::prismatic : JointKind::fixed;
}

JointDescription joint_of(const Json& joint) {
    JointDescription made{.name = joint.at("name").get<std::string>(),
                          .parent_link = joint.at("parent").get<std::string>(),
                          .child_link = joint.at("child").get<std::string>(),
                          .kind = kind_of(joint.at("kind").get<std::string>()),
                          .T_parent_joint = pose_of(joint.at("T_parent_joint")),
                          .axis = vector_of(joint.at("axis")),
                          .limits = {joint.at("min").get<double>(), joint.at("max").get<double>(), 0.0}};
    const auto mimic = joint.find("mimic");
    if (mimic != joint.end() && mimic->is_object())
        made.mimic = JointMimic{mimic->at("joint").get<std::string>(), mimic->at("multiplier").get<double>(),
                                mimic->at("offset").get<double>()};
    return made;
}

LinkCapsule capsule_of(const Json& capsule) {
    return {.link = capsule.at("link").get<std::string>(),
            .p_link_a = vector_of(capsule.at("a")),
            .p_link_b = vector_of(capsule.at("b")),
            .radius_m = capsule.at("radius_m").get<double>()};
}

template <class T, class Make>
std::vector<T> list_of(const Json& list, Make make) {
    // Far more than a rig has; work for each of them is bounded by it.
    constexpr std::size_t kMost = 4096;
    if (list.size() > kMost) throw std::length_error("more elements than a rig can have");
    std::vector<T> made;
    for (const Json& one : list) made.push_back(make(one));
    return made;
}

}  // namespace

std::string SensorFacts::label() const {
    return fmt::format("n{}_s{}", node, sensor);
}

std::optional<std::string> CameraFacts::topic() const {
    constexpr std::string_view kScheme = "ros:";
    if (!device.starts_with(kScheme)) return std::nullopt;
    return device.substr(kScheme.size());
}

const SensorFacts* RobotFacts::find_sensor(std::uint8_t node, std::uint8_t sensor) const noexcept {
    const auto found = std::ranges::find_if(
        sensors, [node, sensor](const SensorFacts& one) { return one.node == node && one.sensor == sensor; });
    return found == sensors.end() ? nullptr : &*found;
}

bool RobotFacts::has_link(const std::string& link) const {
    return std::ranges::find(links, link) != links.end();
}

Result<RobotFacts, std::string> robot_facts(const Json& described) {
    try {
        return RobotFacts{
            .rig = described.at("rig").get<std::string>(),
            .reloads = described.at("reloads").get<std::uint64_t>(),
            .root_link = described.at("root_link").get<std::string>(),
            .base_link = described.at("base_link").get<std::string>(),
            .T_root_base = pose_of(described.at("T_root_base")),
            .T_root_map = pose_of(described.at("T_root_map")),
            .links = described.at("links").get<std::vector<std::string>>(),
            .joints = list_of<JointDescription>(described.at("joints"), joint_of),
            .body = list_of<LinkCapsule>(described.at("body"), capsule_of),
            .joint_sources = list_of<JointSourceFacts>(described.at("joint_sources"), source_of),
            .sensors = list_of<SensorFacts>(described.at("sensors"), sensor_of),
            .cameras = list_of<CameraFacts>(described.at("cameras"), camera_of)};
    } catch (const std::exception& error) {  // of JSON, or a length
        return unexpected(std::string(error.what()));
    }
}

}  // namespace octoskin::bridge
