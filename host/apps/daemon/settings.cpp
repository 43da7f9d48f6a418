#include "host/apps/daemon/settings.hpp"

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>

#include "host/apps/profile/named_mapping.hpp"
#include "host/apps/profile/rig_pipeline.hpp"
#include "host/apps/recording/given_rig.hpp"
#include "host/apps/recording/permission.hpp"
#include "host/apps/robot/fitted_robot.hpp"
#include "host/io/mapping/mapping_file.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin {

namespace {

/// The settings as text, for recordings.
Result<RecordedSettings, AppError> recorded_settings(const rig::Rig& rig, const MappingConfig& mapping,
                                                     const std::string& interface) {
    auto robot = robot_text(rig);
    if (!robot) return unexpected(robot.error());
    const std::uint32_t placement = rig::placement_crc32(rig, *robot);
    return RecordedSettings{.rig = rig::canonical_text(rig, "robot.urdf"),
                            .robot = std::move(*robot),
                            .mapping = mapping_text(mapping),
                            .rig_hash = rig::rig_hash(rig),
                            .placement_crc32 = placement,
                            .joints = rig.joint_counts(),
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

Result<Settings, AppError> settings_of(const rig::Rig& rig, const DaemonRequest& request) {
    const auto configuration = named_mapping(request.configuration);
    if (!configuration) return unexpected(configuration.error());
    auto host = make_host_setup(rig);
    if (!host) return unexpected(reading_error(ExitCode::bad_config, host.error()));
    if (!request.camera_uri.empty() && !rig.camera) {
        return fail(ExitCode::usage,
                    {.code = ErrorCode::conflict,
                     .what = "the rig has no camera for " + request.camera_uri,
                     .remedy = "add one with its pose and its mode to the rig, or leave --camera out",
                     .file = request.rig,
                     .key = "--camera"});
    }
    if (auto chosen = choose_local_joints(host->rig, request); !chosen) return unexpected(chosen.error());
    auto recorded = recorded_settings(rig, configuration->mapping, request.interface);
    if (!recorded) return unexpected(recorded.error());
    return Settings{std::move(host).value(), configuration->mapping, std::move(recorded).value()};
}

}  // namespace

Result<Settings, AppError> read_settings(const DaemonRequest& request) {
    const auto rig = read_rig_with_body(request.rig, request.robot, BodyFitting::kept_only);
    if (!rig) return unexpected(rig.error());
    return settings_of(*rig, request);
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
