// The commands of octoskin-bridge.
#pragma once

#include <CLI/CLI.hpp>

namespace octoskin::bridge {

void add_run_command(CLI::App& app);
void add_status_command(CLI::App& app);
void add_pose_command(CLI::App& app);
void add_robot_command(CLI::App& app);
void add_view_command(CLI::App& app);
void add_export_command(CLI::App& app);
void add_import_command(CLI::App& app);

}  // namespace octoskin::bridge
