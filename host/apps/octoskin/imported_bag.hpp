// An MCAP file of ROS 2 as a temporary recording, made by the program of the package octoskin-bridge.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host/apps/recording/unfinished.hpp"
#include "host/apps/robot/given_robot.hpp"
#include "host/io/folder/open_folder.hpp"

namespace octoskin::app {

/// How messages of a bag are used.
struct BagOptions {
    std::string joint_states;
    std::vector<std::string> can;
    bool uses_log_time = false;
    [[nodiscard]] bool is_any_given() const { return !joint_states.empty() || !can.empty() || uses_log_time; }
};
/// --joint-states, --can and --log-time. `options` has to outlive `command`.
void add_bag_options(CLI::App& command, BagOptions& options);

/// A file whose name ends with .mcap, or the only one of a folder of `ros2 bag` (with a metadata.yaml and
/// without a can.log). Empty: neither. Throws CommandFailure (usage) if the folder has several.
[[nodiscard]] std::optional<std::filesystem::path> bag_of(const std::filesystem::path& recording);

class ImportedBag {
  public:
    /// Imports the bag into a new folder in $TMPDIR; the program prints what it uses, or its error: then this
    /// throws CLI::RuntimeError with its exit code. `command`: of this program. Throws CommandFailure if the
    /// program or the folder is missing.
    ImportedBag(const CLI::App& command, const std::filesystem::path& bag, const std::filesystem::path& rig,
                const GivenRobot& robot, const BagOptions& options);
    /// Removes the folder.
    ~ImportedBag();
    ImportedBag(const ImportedBag&) = delete;
    ImportedBag& operator=(const ImportedBag&) = delete;

    [[nodiscard]] std::filesystem::path recording() const { return work_.shown("recording"); }

  private:
    OpenFolder parent_;
    OpenFolder work_;
    Unfinished unfinished_;
};

}  // namespace octoskin::app
