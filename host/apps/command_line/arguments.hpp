// What command-line arguments must be: checks with one message and one exit code for every command.
#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <optional>
#include <string>
#include <type_traits>

#include "host/io/socketcan/can_socket.hpp"

namespace octoskin::app {

/// Throws CommandFailure with ExitCode::no_input unless the argument is a file that exists.
[[nodiscard]] CLI::Validator existing_file();
/// The same for a file or a directory.
[[nodiscard]] CLI::Validator existing_path();
/// A seed: a whole number from 0 to 2^64 - 1.
[[nodiscard]] CLI::Validator seed();
/// A number of T's kind within these.
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
/// What --configuration takes.
[[nodiscard]] std::string configuration_help(const std::string& use);

/// Throws CommandFailure with ExitCode::usage if the first word is no command, and says which one is like it,
/// and `others`.
void check_command_name(const CLI::App& app, const std::string& others, int argc, const char* const* argv);

/// "fd:N" in place of an interface names a descriptor that whoever started this program left open for it;
/// empty for any other name. CommandFailure (usage) if none of that number is open.
[[nodiscard]] std::optional<int> descriptor_of(const std::string& interface);

/// The interface, or the open socket that fd:N names. CommandFailure: unavailable, or as descriptor_of().
[[nodiscard]] socketcan::CanSocket open_can(const std::string& interface,
                                            const socketcan::SocketOptions& options = {});

}  // namespace octoskin::app
