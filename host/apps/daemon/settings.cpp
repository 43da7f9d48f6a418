#include "host/apps/daemon/settings.hpp"

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
                            .joints = rig.joints.joints.size(),
                            .interface = interface};
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
    config.intake.has_local_joints = !request.joint_socket.empty();
    return build_pipeline(request.rig.string(), settings.host.rig, settings.host.robot, settings.mapping,
                          config);
}

}  // namespace octoskin
