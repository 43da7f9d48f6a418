// Standard output that does not lose its errors: a disk that is full shows when the last of it is written.
#pragma once

#include <fmt/format.h>

#include <optional>
#include <string_view>
#include <utility>

#include "host/apps/recording/app_error.hpp"

namespace octoskin::app {

/// Opens what nobody gave us of standard input, output and error, so that no file of ours takes its number
/// and receives what is meant for it. Reading and writing there still fails. To be called first.
void reserve_standard_descriptors();

/// What cannot be written is told by flush_standard_output(); the work goes on.
void print_text(std::string_view text);

template <typename... T>
void print(fmt::format_string<T...> format, T&&... values) {
    print_text(fmt::format(format, std::forward<T>(values)...));
}

/// Writes what still waits. Returns why not all of it could be written; a reader that
/// went away on its own (`| head`) is no reason.
[[nodiscard]] std::optional<AppError> flush_standard_output();

}  // namespace octoskin::app
