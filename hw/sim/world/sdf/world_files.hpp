// The files that a world may refer to. A reader with such an object opens no other files.
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

    /// The path of the checked descriptor of `file`, an ordinary file; valid as long as this object. The
    /// error does not contain the file's name.
    [[nodiscard]] virtual Result<std::filesystem::path, std::string> openable(
        const std::filesystem::path& file) const = 0;
};

}  // namespace octoskin::sim
