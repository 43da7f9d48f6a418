// octoskin: the product's command-line program.
#include <unistd.h>

#include "host/apps/command_line/arguments.hpp"
#include "host/apps/command_line/exit_codes.hpp"
#include "host/apps/command_line/program.hpp"
#include "host/apps/daemon/quiet_thread.hpp"
#include "host/apps/octoskin/commands.hpp"
#include "host/apps/octoskin/daemon_signals.hpp"

namespace {

void add_commands(CLI::App& app) {
    using namespace octoskin::app;
    add_replay_command(app);
    add_run_command(app);
    add_status_command(app);
    add_query_command(app);
    add_monitor_command(app);
    add_record_command(app);
    add_explain_command(app);
    add_joints_command(app);
    add_cameras_command(app);
    add_rig_command(app);
    add_robot_command(app);
    add_mapping_command(app);
    add_flash_command(app);
    add_black_box_command(app);
    add_calibrate_command(app);
    add_command_command(app);
    add_repair_command(app);
    add_bridge_command(app);
    add_view_command(app);
    add_export_command(app);
}

}  // namespace

int main(int argc, char** argv) {
    if (octoskin::app::first_argument(argc, argv) == "run") octoskin::app::hold_daemon_signals();
    const int exit_code = octoskin::app::run_program(
        {"octoskin", "One map of what a depth camera and the range sensors on a robot arm see.",
         octoskin::app::exit_codes_text(true) + "\nAn interrupted replay removes what it had not finished. "
                                                "Simulating and judging: octoskin-lab.",
         add_commands, ". To simulate, evaluate and experiment: octoskin-lab"},
        argc, argv);
    if (octoskin::LeavableThread::was_one_left()) ::_exit(exit_code);
    return exit_code;
}
