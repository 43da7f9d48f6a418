// Where the models of worlds lie, as Gazebo's users say it: what "model://NAME/..." in a world means.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace octoskin::sim {

/// The environment's variables with such folders, between colons, in the order in which they are looked in.
inline constexpr const char* kModelFolderVariables[] = {"SDF_PATH", "GZ_SIM_RESOURCE_PATH",
                                                        "IGN_GAZEBO_RESOURCE_PATH", "GAZEBO_MODEL_PATH"};

/// For messages.
inline constexpr const char* kModelFoldersHint =
    "--model-path, SDF_PATH, GZ_SIM_RESOURCE_PATH, IGN_GAZEBO_RESOURCE_PATH or GAZEBO_MODEL_PATH";

inline constexpr std::string_view kModelScheme = "model://";

/// The folders of this process's environment.
[[nodiscard]] std::vector<std::filesystem::path> model_folders();

/// The first file or folder there is for a "model://..."; empty if there is none.
[[nodiscard]] std::optional<std::filesystem::path> find_model_file(std::string_view uri);

/// Has `folders` looked in before all others, by this process and those that it starts from now on. To be
/// called before there are threads.
void put_model_folders_first(const std::vector<std::string>& folders);

}  // namespace octoskin::sim
