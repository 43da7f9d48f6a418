// An MCAP file of ROS 2 as a temporary recording, made by the program of the package octoskin-bridge.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
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

/// A new folder in $TMPDIR for this user only, removed at the end of this object.
class TemporaryFolder {
  public:
    /// Throws CommandFailure (cannot_create).
    TemporaryFolder();
    ~TemporaryFolder();
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    [[nodiscard]] std::filesystem::path shown(const std::filesystem::path& name) const {
        return folder_.shown(name);
    }

  private:
    OpenFolder parent_;
    OpenFolder folder_;
    Unfinished unfinished_;
};

class ImportedBag {
  public:
    /// Imports the bag, a file or a folder of `ros2 bag`, into a new folder in $TMPDIR; the program prints
    /// what it uses, or its error: then this throws CLI::RuntimeError with its exit code. `command`: of this
    /// program. Throws CommandFailure if the program or the folder is missing.
    ImportedBag(const CLI::App& command, const std::filesystem::path& bag, const std::filesystem::path& rig,
                const GivenRobot& robot, const BagOptions& options);
    [[nodiscard]] std::filesystem::path recording() const { return work_.shown("recording"); }

  private:
    TemporaryFolder work_;
};

}  // namespace octoskin::app
