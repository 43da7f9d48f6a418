// octoskin-bridge: the daemon's map on ROS 2's topics, and ROS 2's joint states and images to the daemon.
#include <unistd.h>

#include "host/apps/command_line/exit_codes.hpp"
#include "host/apps/command_line/program.hpp"
#include "host/apps/daemon/quiet_thread.hpp"
#include "host/bridge/octoskin_bridge/commands.hpp"

namespace {

void add_commands(CLI::App& app) {
    using namespace octoskin::bridge;
    add_run_command(app);
    add_status_command(app);
    add_pose_command(app);
    add_robot_command(app);
    add_view_command(app);
    add_export_command(app);
    add_import_command(app);
}

}  // namespace

int main(int argc, char** argv) {
    const int exit_code = octoskin::app::run_program(
        {"octoskin bridge",
         "Speaks ROS 2 with the daemon's map, without an installation of ROS. Without a command: run.",
         octoskin::app::exit_codes_text(false), add_commands, ". The daemon and its map: octoskin"},
        argc, argv);
    if (octoskin::LeavableThread::was_one_left()) ::_exit(exit_code);
    return exit_code;
}
