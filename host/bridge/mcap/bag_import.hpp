// Somebody's bag as a recording: joint states, depth images and CAN frames.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/apps/robot/given_robot.hpp"
#include "host/bridge/mcap/bag_account.hpp"
#include "host/io/folder/file_place.hpp"

namespace octoskin::bridge {

struct BagRequest {
    FilePlace bag;
    std::filesystem::path folder;  ///< new or empty; becomes the recording
    std::filesystem::path rig;
    GivenRobot robot = {};
    std::string joint_states = {};  ///< empty: /joint_states
    std::vector<std::string> can;   ///< empty: the topics of ros2_socketcan
    /// Times are those of the log in place of the headers' stamps.
    bool uses_log_time = false;
};

struct ImportedBag {
    BagAccount topics;
    std::vector<std::string> warnings;  ///< for the user
    std::uint64_t can_frames = 0;       ///< of the recording, made ones included
    std::uint64_t depth_frames = 0;
    double duration_s = 0.0;
};

/// `share` of the work, from 0 to 1.
using ImportReport = std::function<void(double share)>;

/// Reads the bag twice and writes the recording at once, or nothing. Errors: of the bag (bad_data), of rig
/// and robot (bad_config), of the folder (cannot_create), a missing helper (unavailable); no_content if no
/// message can be used.
[[nodiscard]] Result<ImportedBag, AppError> import_bag(const BagRequest& request,
                                                       const ImportReport& report = {});

}  // namespace octoskin::bridge
