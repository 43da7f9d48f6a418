// A file that a command writes in one go, and why it could not.
#pragma once

#include <string>
#include <string_view>
#include <system_error>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/io/folder/file_place.hpp"

namespace octoskin {

/// What to do where an output cannot be made for this reason, such as "make room there, or write elsewhere".
[[nodiscard]] std::string remedy_of(const std::error_code& error);

/// Replaces what was there; a device or a pipe that was typed takes it, too. A file with several names is
/// replaced, so that the others stay as they are; below a named folder, so is every file, and a link there is
/// replaced, not followed. Error, `cannot_create`: file, the system's reason and what to do, such as "out/x:
/// cannot be written (No space left on device): make room there, or write elsewhere". What was written before
/// the failure stays.
[[nodiscard]] Status<AppError> write_text(const FilePlace& file, std::string_view text);

/// A copy of `from`, made as write_text() makes a file. Error, `cannot_create`.
[[nodiscard]] Status<AppError> copy_file(const FilePlace& from, const FilePlace& to);

}  // namespace octoskin
