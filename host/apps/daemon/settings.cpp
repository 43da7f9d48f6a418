#include "host/apps/daemon/settings.hpp"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

#include "host/apps/profile/named_mapping.hpp"
#include "host/apps/profile/rig_pipeline.hpp"
#include "host/apps/recording/given_rig.hpp"
#include "host/apps/recording/permission.hpp"
#include "host/apps/robot/fitted_robot.hpp"
#include "host/core/rig/camera_text.hpp"
#include "host/io/mapping/mapping_file.hpp"
#include "hw/rigfile/fed_device.hpp"
#include "hw/rigfile/joined.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin {

namespace {

namespace fs = std::filesystem;

std::vector<std::string> texts_of(const rig::Rig& rig, std::string rig::Camera::*text) {
    std::vector<std::string> texts;
    for (const rig::Camera& camera : rig.cameras) texts.push_back(camera.*text);
    return texts;
}

/// The settings as text, for recordings.
Result<RecordedSettings, AppError> recorded_settings(const rig::Rig& rig, const MappingConfig& mapping,
                                                     const std::string& interface) {
    auto robot = robot_text(rig);
    if (!robot) return unexpected(robot.error());
    const std::uint32_t placement = rig::placement_crc32(rig, *robot);
    return RecordedSettings{
        .rig = rig::canonical_text(rig::without_devices(rig), "robot.urdf"),
        .robot = std::move(*robot),
        .mapping = mapping_text(mapping),
        .rig_hash = rig::rig_hash(rig),
        .placement_crc32 = placement,
        .form = {.joints = rig.joint_counts(), .cameras = std::max(rig.cameras.size(), std::size_t{1})},
        .cameras = texts_of(rig, &rig::Camera::name),
        .devices = texts_of(rig, &rig::Camera::device),
        .interface = interface};
}

/// With --joints, the sources that the rig has there come from this machine, or all if it has none there.
Status<AppError> choose_local_joints(HostRig& rig, const DaemonRequest& request) {
    const auto local = std::ranges::find_if(rig.joint_sources, &HostJointSource::is_local);
    const bool has_local = local != rig.joint_sources.end();
    if (request.joint_socket.empty() && has_local) {
        return fail(ExitCode::usage,
                    {.code = ErrorCode::missing_key,
                     .what = "joint states of node " + std::to_string(local->node_id) +
                             " come through a socket (`via: socket`)",
                     .remedy = "name the socket with --joints, or set `via: can` if they come over CAN",
                     .file = request.rig,
                     .key = "--joints"});
    }
    if (!request.joint_socket.empty() && !has_local)
        for (HostJointSource& source : rig.joint_sources) source.is_local = true;
    return Done{};
}

Unexpected<AppError> camera_fault(const DaemonRequest& request, ErrorCode code, std::string what,
                                  std::string remedy, std::string value = {}) {
    return fail(ExitCode::usage, {.code = code,
                                  .what = std::move(what),
                                  .value = std::move(value),
                                  .remedy = std::move(remedy),
                                  .file = request.rig,
                                  .key = "--camera"});
}

/// `given`: "NAME=DEVICE", or the device of a rig's only camera, which may have a '=', too.
Status<AppError> give_device(rig::Rig& rig, const std::string& given, const DaemonRequest& request) {
    const std::size_t end = given.find('=');
    const auto named = end == std::string::npos
                           ? rig.cameras.end()
                           : std::ranges::find(rig.cameras, given.substr(0, end), &rig::Camera::name);
    if (named != rig.cameras.end() && !named->name.empty()) {
        named->device = given.substr(end + 1);
        return Done{};
    }
    const bool has_name = end != std::string::npos && given.find('/') > end && !fs::exists(given);
    if (rig.cameras.size() == 1 && has_name)
        return camera_fault(request, ErrorCode::unknown_name,
                            "the rig's only camera has " + (rig.cameras.front().name.empty()
                                                                ? std::string("no name")
                                                                : "the name " + rig.cameras.front().name),
                            "give --camera " + given.substr(end + 1), "'" + given + "'");
    if (rig.cameras.empty())
        return camera_fault(request, ErrorCode::conflict, "the rig has no camera for " + given,
                            "add one with its pose and its mode to the rig, or leave --camera out");
    if (rig.cameras.size() > 1)
        return camera_fault(request, ErrorCode::unknown_name,
                            "expected NAME=DEVICE with the name of a camera of the rig",
                            "it has " + rig::joined(texts_of(rig, &rig::Camera::name)), "'" + given + "'");
    rig.cameras.front().device = given;
    return Done{};
}

/// Each camera once.
Status<AppError> give_devices(rig::Rig& rig, const DaemonRequest& request) {
    std::vector<std::string> named;
    for (const std::string& given : request.cameras) {
        const std::string name = rig.cameras.size() > 1 ? given.substr(0, given.find('=')) : "";
        if (auto taken = give_device(rig, given, request); !taken) return taken;
        if (std::ranges::find(named, name) != named.end())
            return camera_fault(request, ErrorCode::duplicate, camera_text(name) + " is given twice",
                                "give each camera one device", "'" + given + "'");
        named.push_back(name);
    }
    return Done{};
}

/// Whether two devices are one: the same text, or names of one file.
bool is_same_device(const std::string& a, const std::string& b) {
    std::error_code error;
    return a == b || fs::equivalent(a, b, error);
}

/// Each of several cameras needs a device of its own: "the first" would be one of them twice.
Status<AppError> check_devices(const rig::Rig& rig, const DaemonRequest& request) {
    for (auto camera = rig.cameras.begin(); rig.cameras.size() > 1 && camera != rig.cameras.end(); ++camera) {
        if (camera->device.empty())
            return camera_fault(request, ErrorCode::missing_key,
                                camera_text(camera->name) + " has no device, and the rig has several cameras",
                                "give its `device` in the rig, or --camera " + camera->name +
                                    "=DEVICE (`octoskin cameras` lists them)");
        const auto other = std::ranges::find_if(rig.cameras.begin(), camera, [&](const rig::Camera& before) {
            return is_same_device(before.device, camera->device);
        });
        if (other != camera)
            return camera_fault(
                request, ErrorCode::duplicate,
                camera_text(other->name) + " and " + camera_text(camera->name) + " have the same device",
                "give each its own", "'" + camera->device + "'");
    }
    return Done{};
}

/// The rig's own are checked where they are read.
Status<AppError> check_topics(const rig::Rig& rig, const DaemonRequest& request) {
    for (const rig::Camera& camera : rig.cameras)
        if (!rig::is_good_device(camera.device))
            return camera_fault(request, ErrorCode::bad_value, rig::kGoodDevice,
                                "give a topic such as ros:/camera/depth/image_rect_raw",
                                "'" + camera.device + "'");
    return Done{};
}

Status<AppError> choose_devices(rig::Rig& rig, const DaemonRequest& request) {
    if (!request.has_camera) return Done{};
    if (auto given = give_devices(rig, request); !given) return given;
    if (auto checked = check_topics(rig, request); !checked) return checked;
    return check_devices(rig, request);
}

Result<Settings, AppError> settings_of(rig::Rig rig, const DaemonRequest& request) {
    const auto configuration = named_mapping(request.configuration);
    if (!configuration) return unexpected(configuration.error());
    if (auto chosen = choose_devices(rig, request); !chosen) return unexpected(chosen.error());
    auto host = make_host_setup(rig);
    if (!host) return unexpected(reading_error(ExitCode::bad_config, host.error()));
    if (auto chosen = choose_local_joints(host->rig, request); !chosen) return unexpected(chosen.error());
    auto recorded = recorded_settings(rig, configuration->mapping, request.interface);
    if (!recorded) return unexpected(recorded.error());
    return Settings{std::move(host).value(), configuration->mapping, std::move(recorded).value()};
}

}  // namespace

Result<Settings, AppError> read_settings(const DaemonRequest& request) {
    auto rig = read_rig_with_body(request.rig, request.robot, BodyFitting::kept_only);
    if (!rig) return unexpected(rig.error());
    return settings_of(std::move(rig).value(), request);
}

Result<Pipeline, AppError> make_pipeline(const DaemonRequest& request, const Settings& settings) {
    PipelineConfig config;
    config.maps = {MapFeed::both};
    config.depth_threads = request.depth_threads;
    config.release = Release::once_placed;
    return build_pipeline(request.rig.string(), settings.host.rig, settings.host.robot, settings.mapping,
                          config);
}

}  // namespace octoskin
