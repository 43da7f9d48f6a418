// A folder of one run's own for what is removed afterwards: nothing that anybody else put somewhere is in it.
#pragma once

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/apps/recording/unfinished.hpp"
#include "host/io/folder/open_folder.hpp"

namespace octoskin {

/// Removed, with all that is in it, at the end of its life, and if the process is told to end before.
class WorkFolder {
  public:
    /// A new folder in `parent`, which is open to write to. Error: cannot_create.
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
