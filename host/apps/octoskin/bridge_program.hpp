// The program of the package octoskin-bridge.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace octoskin::app {

/// The arguments of the program so that it prints errors as this one does: `command` is one of this program.
[[nodiscard]] std::vector<std::string> with_form_of_errors(const CLI::App& command,
                                                           std::vector<std::string> words);

/// Throws CommandFailure (unavailable) if the program is not installed: before work that needs it at its end.
void check_bridge();

/// Becomes the program with these arguments. Throws CommandFailure (unavailable) if it is not installed.
[[noreturn]] void become_bridge(std::vector<std::string> words);

/// Runs it with these arguments and returns its exit code; 128 and the signal's number if a signal ended it.
/// Throws CommandFailure (unavailable) if it is not installed or cannot be started.
[[nodiscard]] int run_bridge(std::vector<std::string> words);

}  // namespace octoskin::app
