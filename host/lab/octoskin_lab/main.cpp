// octoskin-lab: simulates a rig, and judges maps by the world that they were made in.
#include "host/apps/command_line/exit_codes.hpp"
#include "host/apps/command_line/program.hpp"
#include "host/lab/octoskin_lab/commands.hpp"

namespace {

void add_commands(CLI::App& app) {
    using namespace octoskin::app;
    add_simulate_command(app);
    add_evaluate_command(app);
    add_experiment_command(app);
    add_depth_command(app);
}

}  // namespace

int main(int argc, char** argv) {
    return octoskin::app::run_program(
        {"octoskin-lab", "Simulates rigs down to their sensors' registers, and judges maps.",
         octoskin::app::exit_codes_text(false) +
             "\nInterrupted, simulate and experiment remove what they had not finished.",
         add_commands, ". To replay, run, query and the like: octoskin"},
        argc, argv);
}
