// A temporary folder of one run. It contains only files of this run.
#pragma once

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/apps/recording/unfinished.hpp"
#include "host/io/folder/open_folder.hpp"

namespace octoskin {

/// Removed with its content by the destructor, and when a signal ends the process.
class WorkFolder {
  public:
    /// Creates a new folder in `parent`, which must be open for writing. Error: cannot_create.
    [[nodiscard]] static Result<WorkFolder, AppError> create(const OpenFolder& parent);
    WorkFolder(WorkFolder&& other) noexcept;
    WorkFolder& operator=(WorkFolder&&) = delete;
    ~WorkFolder();

    [[nodiscard]] const OpenFolder& folder() const noexcept { return folder_; }

  private:
    WorkFolder(OpenFolder parent, OpenFolder folder);
    OpenFolder parent_;
    OpenFolder folder_;
    bool is_moved_from_ = false;
    Unfinished unfinished_;
};

}  // namespace octoskin
