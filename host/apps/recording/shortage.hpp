// Recognises exceptions from a lack of resources, of the system or by a limit of this process: not an
// internal error, and the user can do something.
#pragma once

#include <exception>
#include <optional>
#include <string>

#include "host/apps/recording/app_error.hpp"

namespace octoskin {

/// The missing resource with its limit and remedy (`no_resources`); empty if the exception has another cause.
/// Resources: memory, descriptors, threads, the size of a file.
[[nodiscard]] std::optional<AppError> shortage_in(const std::exception& thrown);

/// The error of that shortage, or else `system_error` with the exception's own text.
[[nodiscard]] Error error_in(const std::exception& thrown);
/// The sentence of error_in().
[[nodiscard]] std::string reason_of(const std::exception& thrown);

}  // namespace octoskin
