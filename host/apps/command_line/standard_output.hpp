// Standard output with error checks: a full disk is detected when the last bytes are written.
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

/// Opens those of standard input, output and error that the caller left closed. Otherwise a file of this
/// program would get such a number and receive the program's output. Reading and writing these descriptors
/// still fails. Must be called first.
void reserve_standard_descriptors();

/// Machine-readable output: the exact bytes. A failed write is reported by flush_standard_output(); the
/// program continues.
void print_exactly(std::string_view text);

/// JSON for programs: every string is exact, and control characters are escaped (printable_json()).
void print_json(std::string_view json);

/// Text for people, in lines made by this program (printable_lines()).
void print_text(std::string_view text);

/// A value for people. A text, which may be a name from outside, becomes one line of printable().
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

/// Writes the buffered output. Returns the error if it could not all be written; a reader that closed its end
/// (`| head`) is not an error.
[[nodiscard]] std::optional<AppError> flush_standard_output();

}  // namespace octoskin::app
