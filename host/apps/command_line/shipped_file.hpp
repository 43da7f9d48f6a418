// The files that ship with octoskin: rigs, robots, worlds.
#pragma once

#include <filesystem>
#include <string>

namespace octoskin::app {

/// A file that ships with octoskin: in share/octoskin beside the program's folder, wherever that is.
[[nodiscard]] std::filesystem::path shipped_file(const std::string& relative);

}  // namespace octoskin::app
