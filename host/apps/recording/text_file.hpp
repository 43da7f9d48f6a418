// A file that a command writes in one go, and why it could not.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"

namespace octoskin {

/// What to do where an output cannot be made for this reason, such as "make room there, or write elsewhere".
[[nodiscard]] std::string remedy_of(const std::error_code& error);

/// Replaces what was there; a device or a pipe takes it, too. Error, `cannot_create`: file, the system's
/// reason and what to do, such as "out/x: cannot be written (No space left on device): make room there, or
/// write elsewhere". What was written before the failure stays.
[[nodiscard]] Status<AppError> write_text(const std::filesystem::path& file, std::string_view text);

}  // namespace octoskin
