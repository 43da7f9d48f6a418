// Checks of command-line arguments, with the same message and exit code in every command.
#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

#include "host/apps/robot/given_robot.hpp"
#include "host/io/socketcan/can_socket.hpp"

namespace octoskin::app {

/// Throws CommandFailure with ExitCode::no_input unless the argument is an existing file.
[[nodiscard]] CLI::Validator existing_file();
/// As existing_file(), for a file or a directory.
[[nodiscard]] CLI::Validator existing_path();
/// --robot, a file that must exist, and --package-path. `robot` has to outlive `command`.
void add_robot_options(CLI::App& command, GivenRobot& robot, const std::string& robot_help);
/// --package-path alone. `packages` has to outlive `command`.
void add_package_paths(CLI::App& command, std::vector<PackagePath>& packages);
/// A seed: a whole number from 0 to 2^64 - 1.
[[nodiscard]] CLI::Validator seed();
/// A number of type T from `min` to `max`.
template <class T>
[[nodiscard]] CLI::Validator from_to(T min, T max) {
    const std::string range = fmt::format("from {} to {}", min, max);
    return {[range, min, max](const std::string& text) -> std::string {
                T value{};
                const char* const end = text.data() + text.size();
                const auto parsed = std::from_chars(text.data(), end, value);
                const bool is_number = parsed.ec == std::errc{} && parsed.ptr == end;
                if (is_number && value >= min && value <= max) return {};
                const char* const kind = std::is_integral_v<T> ? "a whole number " : "a number ";
                return "expected " + (kind + range) + ", found '" + text + "'";
            },
            range};
}
/// The help text of --configuration.
[[nodiscard]] std::string configuration_help(const std::string& use);

/// The option before the command with which errors are printed as JSON.
inline constexpr std::string_view kJsonErrors = "--json-errors";
[[nodiscard]] bool wants_json_errors(int argc, const char* const* argv) noexcept;
/// Throws CommandFailure if the option is anywhere but before the command.
void check_json_errors(int argc, const char* const* argv);
/// The first argument after the program and kJsonErrors; empty if there is none.
[[nodiscard]] std::string_view first_argument(int argc, const char* const* argv) noexcept;

/// Throws CommandFailure with ExitCode::usage if the first word is not a command. The remedy contains the
/// most similar command and `others`.
void check_command_name(const CLI::App& app, const std::string& others, int argc, const char* const* argv);

/// After a failed parse: throws CommandFailure with ExitCode::usage if an option is none of the command. The
/// remedy contains the most similar one. A command that is another program has no options of its own.
void check_option_names(const CLI::App& app, const std::string& program);

/// The descriptor of "fd:N", which is used in place of an interface name; the calling program left it open.
/// Empty for any other name. CommandFailure (usage) if no open descriptor has that number.
[[nodiscard]] std::optional<int> descriptor_of(const std::string& interface);

/// Opens the interface, or takes the open socket of "fd:N". CommandFailure: unavailable, or as
/// descriptor_of().
[[nodiscard]] socketcan::CanSocket open_can(const std::string& interface,
                                            const socketcan::SocketOptions& options = {});

}  // namespace octoskin::app
