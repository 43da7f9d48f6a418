// What command-line arguments must be: checks with one message and one exit code for every command.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

namespace octoskin::app {

/// Throws CommandFailure with ExitCode::no_input unless the argument is a file that exists.
[[nodiscard]] CLI::Validator existing_file();
/// The same for a file or a directory.
[[nodiscard]] CLI::Validator existing_path();
/// A seed: a whole number from 0 to 2^64 - 1.
[[nodiscard]] CLI::Validator seed();
/// What --configuration takes.
[[nodiscard]] std::string configuration_help(const std::string& use);

/// Throws CommandFailure with ExitCode::usage if the first word is no command, and says which one is like it.
void check_command_name(const CLI::App& app, int argc, const char* const* argv);

/// "fd:N" in place of an interface names a descriptor that whoever started this program left open for it;
/// empty for any other name. CommandFailure (usage) if none of that number is open.
[[nodiscard]] std::optional<int> descriptor_of(const std::string& interface);

}  // namespace octoskin::app
