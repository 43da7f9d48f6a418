// The option for the folders in which the models of a world are searched.
#pragma once

#include <CLI/CLI.hpp>

namespace octoskin::app {

/// --model-path: the folders come before those of the environment.
void add_model_path(CLI::App& command);

}  // namespace octoskin::app
