// The common frame of all programs with subcommands: standard descriptors, limits, help, exit codes.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

namespace octoskin::app {

struct Program {
    std::string name;         ///< as shown in log messages
    std::string description;  ///< one line for --help
    std::string footer;       ///< its exit codes
    std::function<void(CLI::App&)> add_commands;
    std::string others = {};  ///< the end of the message for an unknown command: the name of the program that
                              ///< has the other commands
};

/// Parses the command line, runs the command and returns the exit code. An exception of a command, or output
/// that cannot be written, becomes a message (with --json-errors one line of JSON) on standard error and an
/// exit code. `program` adds its commands
/// to a parser; exactly one command is required.
[[nodiscard]] int run_program(const Program& program, int argc, char** argv) noexcept;

}  // namespace octoskin::app
