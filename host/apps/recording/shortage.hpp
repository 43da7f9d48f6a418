// What was thrown because the system, or a limit that was set for this process, has too little of something:
// that is no defect, and there is something to be done about it.
#pragma once

#include <exception>
#include <optional>

#include "host/apps/recording/app_error.hpp"

namespace octoskin {

/// What there is too little of, with its limit and what to do (`no_resources`); empty: it was thrown for
/// another reason. Memory, descriptors, threads, the size of a file.
[[nodiscard]] std::optional<AppError> shortage_in(const std::exception& thrown);

}  // namespace octoskin
