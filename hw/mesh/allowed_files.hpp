// The files that a reader may open. A reader with such an object opens no other files.
#pragma once

#include <filesystem>
#include <string>

#include "common/result.hpp"

namespace octoskin {

/// For example the files of a folder that is not trusted.
class AllowedFiles {
  public:
    AllowedFiles() = default;
    AllowedFiles(const AllowedFiles&) = delete;
    AllowedFiles& operator=(const AllowedFiles&) = delete;
    virtual ~AllowedFiles() = default;

    /// The path of the checked descriptor of `file`, an ordinary file; valid as long as this object. The
    /// error does not contain the file's name.
    [[nodiscard]] virtual Result<std::filesystem::path, std::string> openable(
        const std::filesystem::path& file) const = 0;
};

}  // namespace octoskin
