// Writes a whole file at once, with the cause and remedy of an error.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <system_error>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/io/folder/file_place.hpp"

namespace octoskin {

/// The remedy for this error of an output, such as "make room there, or write elsewhere".
[[nodiscard]] std::string remedy_of(const std::error_code& error);

/// Replaces an existing file: the text is written beside it and renamed into place. Links are not followed,
/// and other hard links of the old file stay unchanged. A device, a pipe or a descriptor (/dev/stdout) named
/// directly is written to.
/// Error, `cannot_create`: file, the system's reason and the remedy, such as "out/x: cannot be written (No
/// space left on device): make room there, or write elsewhere"; the old file is then unchanged.
[[nodiscard]] Status<AppError> write_text(const FilePlace& file, std::string_view text);

/// Checks without writing, as far as possible, that write_text() would succeed: for long work before a write.
[[nodiscard]] Status<AppError> check_text_place(const FilePlace& file);

/// Error, `usage`: `output`, unless it is empty, is one of these files, by its name or through a link.
[[nodiscard]] Status<AppError> check_replaces_none(const std::filesystem::path& output,
                                                   std::span<const std::filesystem::path> files);

/// A copy of `from`, written as by write_text(). Error, `cannot_create`.
[[nodiscard]] Status<AppError> copy_file(const FilePlace& from, const FilePlace& to);

}  // namespace octoskin
