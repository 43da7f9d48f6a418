// A file that a command writes in one go, and why it could not.
#pragma once

#include <filesystem>
#include <string_view>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"

namespace octoskin {

/// Replaces what was there; a device or a pipe takes it, too. Error, `cannot_create`: file, the system's
/// reason and what to do, such as "out/x: cannot be written (No space left on device): make room there, or
/// write elsewhere". What was written before the failure stays.
[[nodiscard]] Status<AppError> write_text(const std::filesystem::path& file, std::string_view text);

}  // namespace octoskin
