// One daemon for each folder of maps: two would overwrite each other's.
#pragma once

#include <filesystem>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"

namespace octoskin {

/// Holds the folder until it is destroyed, or the process ends in any way.
class FolderLock {
  public:
    /// Makes the folder if it is not there. Refuses, naming its process, if somebody else holds it, and if
    /// nothing can be written there.
    [[nodiscard]] static Result<FolderLock, AppError> take(const std::filesystem::path& folder);
    FolderLock(FolderLock&& other) noexcept;
    FolderLock& operator=(FolderLock&& other) noexcept;
    ~FolderLock();

  private:
    explicit FolderLock(int descriptor) : descriptor_(descriptor) {}
    int descriptor_ = -1;
};

}  // namespace octoskin
