// The settings from the daemon's command line, and from the files named there.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>

#include "common/result.hpp"
#include "host/apps/daemon/recorder.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/apps/robot/given_robot.hpp"
#include "host/core/mapping/mapping_config.hpp"
#include "host/core/pipeline/pipeline.hpp"
#include "host/io/mapping/mapping_file.hpp"
#include "host/io/rig/host_rig_reader.hpp"

namespace octoskin {

struct DaemonRequest {
    std::filesystem::path rig;
    GivenRobot robot;
    std::string configuration =
        kDefaultMapping;  ///< how measurements become voxels: a built-in one, or a file
    std::string interface = "can0";
    /// Used instead of the interface: a descriptor that carries frames as a raw CAN socket does.
    std::optional<int> can_descriptor;
    bool is_listen_only = false;  ///< transmits nothing, SYNC included
    bool has_camera = true;       ///< if the rig has one
    /// Devices of OpenNI2, .oni files, or "ros:" with a topic, in place of the rig's: "NAME=DEVICE", or
    /// without NAME for a rig with one camera.
    std::vector<std::string> cameras;
    std::filesystem::path joint_socket;  ///< empty: joint states come over CAN only
    std::filesystem::path control_socket;
    std::filesystem::path map_folder;
    std::chrono::seconds save_period{20};
    unsigned depth_threads = 1;  ///< of each camera: threads that work on an image
};

/// Read at the start, and again at each SIGHUP.
struct Settings {
    HostSetup host;
    MappingConfig mapping;
    RecordedSettings recorded;  ///< the same as text, for recordings
};

/// Errors name the file, the line and what to do.
[[nodiscard]] Result<Settings, AppError> read_settings(const DaemonRequest& request);
[[nodiscard]] Result<Pipeline, AppError> make_pipeline(const DaemonRequest& request,
                                                       const Settings& settings);

}  // namespace octoskin
