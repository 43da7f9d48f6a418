// One daemon for each folder of maps: two would overwrite each other's maps.
#pragma once

#include <filesystem>
#include <utility>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/apps/recording/file_set.hpp"
#include "host/io/folder/open_folder.hpp"

namespace octoskin {

/// Holds the folder until destruction, or until the process ends in any way.
class FolderLock {
  public:
    /// The locked file in the folder.
    static constexpr const char* kFile = kDaemonsLock;

    /// Creates the folder if it is missing. Refuses a folder that another process holds (naming that
    /// process), that cannot be written to, that belongs to another user, or whose lock file is a link or no
    /// regular file. A lock file with several names is replaced, not written to.
    /// Completes the move of a run that was killed while it put its files there. Refuses the folder if that
    /// fails, or if the files wait beside a daemon's map.
    [[nodiscard]] static Result<FolderLock, AppError> take(const std::filesystem::path& folder);
    /// The same for a folder that is open for writing. `named`: the path as the user gave it.
    [[nodiscard]] static Result<FolderLock, AppError> take(const OpenFolder& folder,
                                                           const std::filesystem::path& named);
    /// Why maps cannot be saved in a folder that cannot be opened for writing.
    [[nodiscard]] static AppError cannot_save(const std::filesystem::path& named, const FolderError& error);

    /// The folder that is held; a later folder of the same name is another one.
    [[nodiscard]] const OpenFolder& folder() const noexcept { return folder_; }

  private:
    [[nodiscard]] static Result<FolderLock, AppError> settled(FolderLock lock);
    FolderLock(OpenFolder folder, OpenFile file) : folder_(std::move(folder)), file_(std::move(file)) {}
    OpenFolder folder_;
    OpenFile file_;
};

}  // namespace octoskin
