// What the commands that play a recording through the pipeline ask for alike.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>

#include "host/apps/playback/playback.hpp"

namespace octoskin::app {

struct PlaybackOptions {
    std::filesystem::path recording;
    std::filesystem::path rig;    ///< empty: the recording's
    std::filesystem::path robot;  ///< empty: the recording's
    std::string camera;           ///< of a data set without rig; empty: as its layout has it
    std::string pose;             ///< of the camera of a lone .oni; empty: the rig's
    std::string configuration;    ///< empty: the recording's own, or the default
    bool is_by_capture_time = false;
};

/// All of them but the recording, for which each command has its own place. `options` has to outlive
/// `command`.
void add_playback_options(CLI::App& command, PlaybackOptions& options);

/// What they ask for; the maps, the pace and the listener are the command's own. CommandFailure if the
/// configuration or the pose is none.
[[nodiscard]] PlaybackRequest playback_request(const PlaybackOptions& options);

}  // namespace octoskin::app
