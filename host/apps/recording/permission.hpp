// Files that are there and may not be read: not to be taken for absent or broken ones.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "host/apps/recording/app_error.hpp"
#include "host/io/folder/file_place.hpp"

namespace octoskin {

/// ExitCode::no_permission if this process may not read the file or directory, or not look for it; empty if
/// it may, or if nothing is there.
[[nodiscard]] std::optional<AppError> refused_to_read(const FilePlace& file);

/// Why reading `file` failed: that it may not be read, else what `otherwise` says.
[[nodiscard]] AppError reading_error(const FilePlace& file, AppError otherwise);

/// The same of an error of a reader, which knows its file.
template <class Error>
[[nodiscard]] AppError reading_error(ExitCode otherwise, const Error& error) {
    return reading_error(error.file, {otherwise, error.message()});
}

}  // namespace octoskin
