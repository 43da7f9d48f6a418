// Files installed with octoskin: rigs, robots, worlds.
#pragma once

#include <filesystem>
#include <string>

namespace octoskin::app {

/// The path of an installed file: share/octoskin beside the folder of the running program.
[[nodiscard]] std::filesystem::path shipped_file(const std::string& relative);

}  // namespace octoskin::app
