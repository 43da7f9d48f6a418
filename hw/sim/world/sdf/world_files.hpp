// Which files a world may refer to: a reader that is given one of these opens nothing else.
#pragma once

#include <filesystem>
#include <string>

#include "common/result.hpp"

namespace octoskin::sim {

/// The files of a folder that is not trusted.
class WorldFiles {
  public:
    WorldFiles() = default;
    WorldFiles(const WorldFiles&) = delete;
    WorldFiles& operator=(const WorldFiles&) = delete;
    virtual ~WorldFiles() = default;

    /// The path under which `file`, an ordinary one, can be opened as it was checked: its descriptor's, valid
    /// as long as this object. The error says what is wrong with it, without its name.
    [[nodiscard]] virtual Result<std::filesystem::path, std::string> openable(
        const std::filesystem::path& file) const = 0;
};

}  // namespace octoskin::sim
