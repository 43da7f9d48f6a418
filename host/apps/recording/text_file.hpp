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

/// Replaces what was there: the text is written beside it and renamed into its place, so that no link is
/// written through and of a file with several names the others stay as they are. A device, a pipe or a
/// descriptor (/dev/stdout) that was typed itself takes it, too. Error, `cannot_create`: file, the system's
/// reason and what to do, such as "out/x: cannot be written (No space left on device): make room there, or
/// write elsewhere"; what was there is as it was then.
[[nodiscard]] Status<AppError> write_text(const FilePlace& file, std::string_view text);

/// That write_text() could, as far as can be seen without writing: for what works for long before it writes.
[[nodiscard]] Status<AppError> check_text_place(const FilePlace& file);

/// A copy of `from`, made as write_text() makes a file. Error, `cannot_create`.
[[nodiscard]] Status<AppError> copy_file(const FilePlace& from, const FilePlace& to);

}  // namespace octoskin
