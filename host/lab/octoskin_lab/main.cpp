// octoskin-lab: simulates a rig, and judges maps by the world that they were made in.
#include "host/apps/command_line/program.hpp"
#include "host/lab/octoskin_lab/commands.hpp"

namespace {

constexpr const char* kFooter =
    "Exit codes: 0 done; 1 done, with a bad result; 64 command line; 65 unusable data; 66 no such file;\n"
    "69 a program or device is missing; 70 a defect of octoskin; 71 too little memory, descriptors or\n"
    "threads (ulimit); 73 cannot write; 74 a device, standard input or output failed; 77 no permission;\n"
    "78 rig, robot, scenario or mapping file; 129, 130, 143 interrupted by SIGHUP, Ctrl-C, SIGTERM: what\n"
    "simulate and experiment had not finished is removed.";

void add_commands(CLI::App& app) {
    using namespace octoskin::app;
    add_simulate_command(app);
    add_evaluate_command(app);
    add_experiment_command(app);
}

}  // namespace

int main(int argc, char** argv) {
    return octoskin::app::run_program(
        {"octoskin-lab", "Simulates rigs down to their sensors' registers, and judges maps.", kFooter,
         add_commands, ". To replay, run, query and the like: octoskin"},
        argc, argv);
}
