#include "host/apps/daemon/settings.hpp"

#include <sys/stat.h>

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "host/apps/profile/named_mapping.hpp"
#include "host/apps/profile/rig_pipeline.hpp"
#include "host/apps/recording/given_rig.hpp"
#include "host/apps/recording/permission.hpp"
#include "host/io/mapping/mapping_file.hpp"
#include "hw/rigfile/rig.hpp"

namespace octoskin {

namespace {

constexpr int kReadingsMax = 5;

/// Identity of a file, and the time of its last change.
struct FileStamp {
    dev_t device = 0;
    ino_t number = 0;
    std::int64_t written_ns = 0;
    std::int64_t changed_ns = 0;
    friend bool operator==(const FileStamp&, const FileStamp&) = default;
};

std::optional<FileStamp> stamp_of(const FilePlace& file) {
    constexpr std::int64_t kSecond_ns = 1'000'000'000;
    const auto opened = file.open();
    struct stat status {};
    if (!opened || ::fstat(opened->descriptor(), &status) != 0) return std::nullopt;
    return FileStamp{status.st_dev, status.st_ino,
                     status.st_mtim.tv_sec * kSecond_ns + status.st_mtim.tv_nsec,
                     status.st_ctim.tv_sec * kSecond_ns + status.st_ctim.tv_nsec};
}

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

/// The robot's file is read several times: for its links, its body, its joints and as text. It may be saved
/// meanwhile: the result is valid only if it was the same file before and after all of it.
Result<Settings, AppError> read_settings(const DaemonRequest& request) {
    std::optional<std::string> text_before;
    std::optional<FileStamp> stamp_before;
    for (int attempt = 0; attempt < kReadingsMax; ++attempt) {
        const auto rig = read_given_rig(request.rig, request.robot);
        if (!rig) return unexpected(rig.error());
        auto settings = settings_of(*rig, request);
        if (!settings) return settings;
        const auto stamp = stamp_of(rig->urdf);
        if (stamp && stamp == stamp_before && settings->recorded.robot == text_before) return settings;
        text_before = std::move(settings->recorded.robot);
        stamp_before = stamp;
    }
    return fail(ExitCode::bad_config,
                {.code = ErrorCode::in_use,
                 .what = "its robot's URDF was saved again during each attempt to read it",
                 .remedy = "let the other program end its work on that file",
                 .file = request.rig});
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
