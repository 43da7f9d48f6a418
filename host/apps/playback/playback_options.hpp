// The options shared by the commands that play a recording through the pipeline.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>

#include "host/apps/playback/playback.hpp"
#include "host/apps/robot/given_robot.hpp"

namespace octoskin::app {

struct PlaybackOptions {
    std::filesystem::path recording;
    std::filesystem::path rig;  ///< empty: the recording's
    GivenRobot robot;
    std::string camera;         ///< of a data set; empty: the rig's only one, or by its layout
    std::string pose;           ///< of the camera of a lone .oni; empty: the rig's
    std::string configuration;  ///< empty: the recording's own, or the default
    bool is_by_capture_time = false;
};

/// Adds those of a recording of a robot, except the recording: --configuration, --rig, --robot,
/// --package-path and --by-capture-time. `options` has to outlive `command`.
void add_recording_options(CLI::App& command, PlaybackOptions& options);
/// Adds all of them except the recording, which each command adds itself. `options` has to outlive `command`.
void add_playback_options(CLI::App& command, PlaybackOptions& options);

/// The request for these options; the command itself adds the maps, the pace and the listener. Throws
/// CommandFailure if the configuration or the pose is not valid.
[[nodiscard]] PlaybackRequest playback_request(const PlaybackOptions& options);

}  // namespace octoskin::app
