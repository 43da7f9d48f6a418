// The subcommands of `octoskin`, one file each. Each adds itself to the parser; its callback throws
// CommandFailure.
#pragma once

#include <CLI/CLI.hpp>

namespace octoskin::app {

void add_replay_command(CLI::App& app);
void add_explain_command(CLI::App& app);
void add_run_command(CLI::App& app);
void add_status_command(CLI::App& app);
void add_query_command(CLI::App& app);
void add_monitor_command(CLI::App& app);
void add_record_command(CLI::App& app);
void add_joints_command(CLI::App& app);
void add_cameras_command(CLI::App& app);
void add_rig_command(CLI::App& app);
void add_robot_command(CLI::App& app);
void add_mapping_command(CLI::App& app);
void add_flash_command(CLI::App& app);
void add_black_box_command(CLI::App& app);
void add_calibrate_command(CLI::App& app);
void add_command_command(CLI::App& app);
void add_repair_command(CLI::App& app);
void add_bridge_command(CLI::App& app);
void add_view_command(CLI::App& app);
void add_export_command(CLI::App& app);

}  // namespace octoskin::app
