// The subcommands of `octoskin`, one file each. Each adds itself to the parser; its callback throws
// CommandFailure, which main turns into a message and an exit code.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <utility>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"

namespace octoskin::app {

class CommandFailure : public std::runtime_error {
  public:
    explicit CommandFailure(const AppError& error) : std::runtime_error(error.message), code_(error.code) {}
    [[nodiscard]] ExitCode code() const noexcept { return code_; }

  private:
    ExitCode code_;
};

/// What the result holds; throws its error as CommandFailure.
template <class T>
[[nodiscard]] T value_or_fail(Result<T, AppError> result) {
    if (!result) throw CommandFailure(result.error());
    return std::move(result).value();
}

void add_simulate_command(CLI::App& app);
void add_replay_command(CLI::App& app);
void add_explain_command(CLI::App& app);
void add_evaluate_command(CLI::App& app);
void add_experiment_command(CLI::App& app);
void add_run_command(CLI::App& app);
void add_status_command(CLI::App& app);
void add_query_command(CLI::App& app);
void add_monitor_command(CLI::App& app);
void add_record_command(CLI::App& app);
void add_joints_command(CLI::App& app);
void add_cameras_command(CLI::App& app);
void add_rig_command(CLI::App& app);
void add_mapping_command(CLI::App& app);
void add_flash_command(CLI::App& app);
void add_black_box_command(CLI::App& app);
void add_calibrate_command(CLI::App& app);
void add_command_command(CLI::App& app);
void add_repair_command(CLI::App& app);

/// A file that ships with octoskin: in share/octoskin beside the program's folder, wherever that is.
[[nodiscard]] std::filesystem::path shipped_file(const std::string& relative);

}  // namespace octoskin::app
