// What every program with subcommands does around them: standard descriptors, limits, help, exit codes.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

namespace octoskin::app {

struct Program {
    std::string name;         ///< as it logs
    std::string description;  ///< one line for --help
    std::string footer;       ///< its exit codes
    std::function<void(CLI::App&)> add_commands;
    std::string others = {};  ///< which program has further commands, as the message of an unknown one ends
};

/// Parses the command line, runs the command, and returns the exit code. What a command throws becomes a
/// message on standard error and an exit code; so does output that cannot be written. `program` adds its
/// commands to a parser; exactly one of them is required.
[[nodiscard]] int run_program(const Program& program, int argc, char** argv) noexcept;

}  // namespace octoskin::app
