#include "host/apps/octoskin/playback_options.hpp"

#include <spdlog/spdlog.h>

#include "host/apps/choosing/named_mapping.hpp"
#include "host/apps/octoskin/arguments.hpp"
#include "host/apps/octoskin/commands.hpp"
#include "host/apps/playback/data_set_playback.hpp"
#include "host/io/mapping/mapping_file.hpp"
#include "host/io/tum/data_set_camera.hpp"
#include "hw/rigfile/joined.hpp"

namespace octoskin::app {
namespace {

/// What --configuration says; else the recording's own mapping.yaml, as the daemon wrote it; else the
/// default.
Result<NamedMapping, AppError> configuration_of(const std::string& asked_for,
                                                const RecordingPaths& recording) {
    if (!asked_for.empty()) return named_mapping(asked_for);
    const FilePlace own = recording.mapping();
    return own.is_there() ? mapping_of_file(own) : named_mapping(kDefaultMapping);
}

}  // namespace

void add_playback_options(CLI::App& command, PlaybackOptions& options) {
    command.add_option("--configuration", options.configuration,
                       configuration_help("How measurements become voxels (default: as the daemon "
                                          "recorded it, else fast)"));
    command.add_option("--rig", options.rig, "Rig (YAML) in place of the recording's")
        ->check(existing_file());
    command.add_option("--robot", options.robot, "Robot (URDF) in place of the recording's")
        ->check(existing_file());
    command.add_option("--camera", options.camera,
                       "Of a TUM RGB-D data set without --rig: " + rig::joined(tum::kDataSetCameras) +
                           " (default: " + std::string(tum::kDataSetCameras.front()) + ")");
    command.add_flag("--by-capture-time", options.is_by_capture_time,
                     "In the order of capture times, even if the recording has a daemon's own order");
}

PlaybackRequest playback_request(const PlaybackOptions& options) {
    const RecordingPaths recording(options.recording);
    if (!options.camera.empty() && (!options.rig.empty() || !is_data_set(recording))) {
        throw CommandFailure(
            {ExitCode::usage,
             "--camera " + options.camera +
                 (options.rig.empty() ? ": " + options.recording.string() +
                                            " is no TUM RGB-D data set, and what recorded it is "
                                            "in its rig: leave --camera out"
                                      : ": the camera is --rig's: give one of them")});
    }
    auto configuration = configuration_of(options.configuration, recording);
    if (!configuration) throw CommandFailure(configuration.error());
    return {.recording = recording,
            .mapping = configuration->mapping,
            .configuration = configuration->name,
            .is_mapping_given = !options.configuration.empty(),
            .maps = {},
            .rig = options.rig,
            .robot = options.robot,
            .camera = options.camera,
            .is_by_capture_time = options.is_by_capture_time,
            .pace = {},
            .listener = nullptr,
            .warn_first = [](const std::string& warning) { spdlog::warn("{}", warning); }};
}

}  // namespace octoskin::app
