// The subcommands of `octoskin-lab`, one file each. Each adds itself to the parser; its callback throws
// CommandFailure.
#pragma once

#include <CLI/CLI.hpp>

namespace octoskin::app {

void add_simulate_command(CLI::App& app);
void add_evaluate_command(CLI::App& app);
void add_experiment_command(CLI::App& app);
void add_depth_command(CLI::App& app);

}  // namespace octoskin::app
