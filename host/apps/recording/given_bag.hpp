// Finds the MCAP file that the user named: itself, or by the folder of `ros2 bag` that has it.
#pragma once

#include <filesystem>
#include <optional>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/io/folder/file_place.hpp"

namespace octoskin {

/// A file whose name ends with .mcap, or the only such name of a folder of `ros2 bag` (with a metadata.yaml
/// and without a can.log): a place in that open folder, so that no link there is followed. Empty: neither.
/// Error (usage): the folder has several.
[[nodiscard]] Result<std::optional<FilePlace>, AppError> find_bag(const std::filesystem::path& named);

/// Any file, or a folder as find_bag(). Error (usage): another folder.
[[nodiscard]] Result<FilePlace, AppError> given_bag(const std::filesystem::path& named);

/// Whether the file's name ends with .mcap.
[[nodiscard]] bool is_named_as_bag(const std::filesystem::path& file);

/// X.maps beside X.mcap, in the same folder.
[[nodiscard]] FilePlace maps_beside(const FilePlace& bag);

}  // namespace octoskin
