// A folder of one run's own for what is removed afterwards: nothing that anybody else put somewhere is in it.
#pragma once

#include <filesystem>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/apps/recording/unfinished.hpp"

namespace octoskin {

/// Removed, with all that is in it, at the end of its life, and if the process is told to end before.
class WorkFolder {
  public:
    /// A new folder under `parent`, which must exist. Error: cannot_create.
    [[nodiscard]] static Result<WorkFolder, AppError> create(const std::filesystem::path& parent);
    WorkFolder(WorkFolder&& other) noexcept;
    WorkFolder& operator=(WorkFolder&&) = delete;
    ~WorkFolder();

    [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

  private:
    explicit WorkFolder(std::filesystem::path path);
    std::filesystem::path path_;  ///< empty: moved from
    Unfinished unfinished_;
};

}  // namespace octoskin
