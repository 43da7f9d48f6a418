// The folders of models, set as in Gazebo: resolves "model://NAME/..." in a world.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace octoskin::sim {

/// The environment variables with such folders, separated by colons, in the order of the search.
inline constexpr const char* kModelFolderVariables[] = {"SDF_PATH", "GZ_SIM_RESOURCE_PATH",
                                                        "IGN_GAZEBO_RESOURCE_PATH", "GAZEBO_MODEL_PATH"};

/// For messages.
inline constexpr const char* kModelFoldersHint =
    "--model-path, SDF_PATH, GZ_SIM_RESOURCE_PATH, IGN_GAZEBO_RESOURCE_PATH or GAZEBO_MODEL_PATH";

inline constexpr std::string_view kModelScheme = "model://";

/// The folders of this process's environment.
[[nodiscard]] std::vector<std::filesystem::path> model_folders();

/// The first existing file or folder for a "model://..."; empty if there is none.
[[nodiscard]] std::optional<std::filesystem::path> find_model_file(std::string_view uri);

/// Puts `folders` before all others in the search of this process and of those that it starts. Call before
/// threads are started.
void put_model_folders_first(const std::vector<std::string>& folders);

}  // namespace octoskin::sim
