// Standard output that does not lose its errors: a disk that is full shows when the last of it is written.
#pragma once

#include <fmt/format.h>

#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "host/apps/recording/app_error.hpp"
#include "host/core/text/printable.hpp"

namespace octoskin::app {

/// Opens what nobody gave us of standard input, output and error, so that no file of ours takes its number
/// and receives what is meant for it. Reading and writing there still fails. To be called first.
void reserve_standard_descriptors();

/// For a machine: the very bytes. What cannot be written is told by flush_standard_output(); the work goes
/// on.
void print_exactly(std::string_view text);

/// JSON for a machine: every string is exact, and none orders a terminal about: printable_json().
void print_json(std::string_view json);

/// For a person, in lines of our own making: printable_lines().
void print_text(std::string_view text);

/// A value for a person; a text, which may be a name of somebody else's, is one line of printable().
template <typename T>
[[nodiscard]] decltype(auto) shown(const T& value) {
    if constexpr (std::is_convertible_v<const T&, std::string_view>) {
        return printable(value);
    } else {
        return value;
    }
}

template <typename... T>
void print(fmt::format_string<decltype(shown(std::declval<const T&>()))...> format, const T&... values) {
    print_text(fmt::format(format, shown(values)...));
}

/// Writes what still waits. Returns why not all of it could be written; a reader that
/// went away on its own (`| head`) is no reason.
[[nodiscard]] std::optional<AppError> flush_standard_output();

}  // namespace octoskin::app
