#include "host/bridge/published/sensor_messages.hpp"

#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "host/bridge/published/float_cloud.hpp"
#include "host/bridge/published/ros_values.hpp"

namespace octoskin::bridge {
namespace {

using Json = nlohmann::ordered_json;
using ros::diagnostic_msgs::DiagnosticStatus;

constexpr const char* kName = "octoskin";

/// +x along the sensor's +z.
Eigen::Isometry3d T_sensor_range_frame() {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() << 0, 0, -1,  //
        0, 1, 0,             //
        1, 0, 0;
    return T;
}

ros::geometry_msgs::TransformStamped frame(const std::string& parent, const std::string& child,
                                           const Eigen::Isometry3d& T_parent_child, WallTime stamp) {
    return {ros_header(stamp, parent), child, ros_transform(T_parent_child)};
}

std::string text_of(const Json& problem, const char* key) {
    const auto found = problem.find(key);
    return found != problem.end() && found->is_string() ? found->get<std::string>() : std::string();
}

DiagnosticStatus status_of(const Json& problem) {
    const std::string on = text_of(problem, "on");
    DiagnosticStatus status{.level = DiagnosticStatus::kWarn,
                            .name = std::string(kName) + ": " + (on.empty() ? "daemon" : on),
                            .message = text_of(problem, "text"),
                            .hardware_id = on.empty() ? kName : on,
                            .values = {}};
    for (const char* key : {"code", "key", "remedy"})
        if (std::string value = text_of(problem, key); !value.empty())
            status.values.push_back({key, std::move(value)});
    return status;
}

}  // namespace

std::string range_frame(const std::string& prefix, const SensorFacts& sensor) {
    return prefix + "_range_" + sensor.label();
}

ros::sensor_msgs::Range range_message(const watch::WatchedRange& range, const SensorFacts& sensor,
                                      const ros::std_msgs::Header& header) {
    return {
        .header = header,
        .radiation_type = ros::sensor_msgs::Range::kInfrared,
        .field_of_view = static_cast<float>(sensor.fov_rad),
        .min_range = static_cast<float>(sensor.range_min_m),
        .max_range = static_cast<float>(sensor.range_max_m),
        .range = range.range_m ? static_cast<float>(*range.range_m) : std::numeric_limits<float>::infinity(),
        .variance = static_cast<float>(range.sigma_m * range.sigma_m)};
}

ros::sensor_msgs::PointCloud2 points_message(std::span<const watch::WatchedRange> ranges,
                                             const ros::std_msgs::Header& header) {
    FloatCloud<3> cloud(header, {"x", "y", "z"});
    for (const watch::WatchedRange& range : ranges) {
        if (!range.range_m) continue;
        const Eigen::Vector3f end = (range.p_map_sensor + *range.range_m * range.direction_map).cast<float>();
        cloud.add({end.x(), end.y(), end.z()});
    }
    return std::move(cloud).take();
}

ros::tf2_msgs::TFMessage static_frames(const RobotFacts& robot, const std::string& prefix,
                                       const std::string& map_frame, WallTime stamp) {
    ros::tf2_msgs::TFMessage message;
    message.transforms.push_back(frame(robot.root_link, map_frame, robot.T_root_map, stamp));
    for (const SensorFacts& sensor : robot.sensors)
        message.transforms.push_back(frame(sensor.link, range_frame(prefix, sensor),
                                           sensor.T_link_sensor * T_sensor_range_frame(), stamp));
    return message;
}

std::string camera_frame(const std::string& prefix, const CameraFacts& camera) {
    return prefix + "_camera" + (camera.name.empty() ? "" : "_" + camera.name);
}

std::vector<ros::geometry_msgs::TransformStamped> camera_frames(const RobotFacts& robot,
                                                                const std::string& prefix, WallTime stamp) {
    std::vector<ros::geometry_msgs::TransformStamped> frames;
    for (const CameraFacts& camera : robot.cameras)
        frames.push_back(frame(camera.link, camera_frame(prefix, camera), camera.T_link_camera, stamp));
    return frames;
}

ros::diagnostic_msgs::DiagnosticArray diagnostics(const Json& status, WallTime stamp) {
    ros::diagnostic_msgs::DiagnosticArray array{.header = ros_header(stamp, ""), .status = {}};
    const auto problems = status.find("problems");
    if (problems != status.end())
        for (const Json& problem : *problems) array.status.push_back(status_of(problem));
    if (array.status.empty())
        array.status.push_back({.level = DiagnosticStatus::kOk,
                                .name = std::string(kName) + ": daemon",
                                .message = "no problems",
                                .hardware_id = kName,
                                .values = {}});
    return array;
}

ros::diagnostic_msgs::DiagnosticArray diagnostics_without_daemon(const std::string& why, WallTime stamp) {
    return {.header = ros_header(stamp, ""),
            .status = {{.level = DiagnosticStatus::kError,
                        .name = std::string(kName) + ": daemon",
                        .message = why,
                        .hardware_id = kName,
                        .values = {}}}};
}

}  // namespace octoskin::bridge
