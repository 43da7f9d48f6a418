// Distinguishes files that may not be read from missing and broken ones.
#pragma once

#include <optional>
#include <utility>

#include "host/apps/recording/app_error.hpp"
#include "host/io/folder/file_place.hpp"

namespace octoskin {

/// ExitCode::no_permission if this process may not read the file or directory, or may not search its folder;
/// empty if it may, or if the file does not exist.
[[nodiscard]] std::optional<AppError> refused_to_read(const FilePlace& file);

/// The error of a failed read of `file`: no permission, else `otherwise`.
[[nodiscard]] AppError reading_error(const FilePlace& file, AppError otherwise);

/// The same for the error of a reader, which contains the file.
[[nodiscard]] inline AppError reading_error(ExitCode otherwise, Error error) {
    const FilePlace file(error.file);
    return reading_error(file, {otherwise, std::move(error)});
}

}  // namespace octoskin
