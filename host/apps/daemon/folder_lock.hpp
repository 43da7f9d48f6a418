// One daemon for each folder of maps: two would overwrite each other's.
#pragma once

#include <filesystem>
#include <utility>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/apps/recording/file_set.hpp"
#include "host/io/folder/open_folder.hpp"

namespace octoskin {

/// Holds the folder until it is destroyed, or the process ends in any way.
class FolderLock {
  public:
    /// The file in the folder that is locked.
    static constexpr const char* kFile = kDaemonsLock;

    /// Makes the folder if it is not there. Refuses, naming its process, if somebody else holds it, if
    /// nothing can be written there, if the folder is somebody else's, and if its file "lock" is a link or no
    /// file. One with several names is replaced, not written to.
    [[nodiscard]] static Result<FolderLock, AppError> take(const std::filesystem::path& folder);
    /// The same of a folder that is open to be written to. `named`: as a person named it.
    [[nodiscard]] static Result<FolderLock, AppError> take(const OpenFolder& folder,
                                                           const std::filesystem::path& named);
    /// Why maps cannot be saved in a folder that cannot be opened to be written to.
    [[nodiscard]] static AppError cannot_save(const std::filesystem::path& named, const FolderError& error);

    /// The folder that is held: what takes its name later is another one.
    [[nodiscard]] const OpenFolder& folder() const noexcept { return folder_; }

  private:
    FolderLock(OpenFolder folder, OpenFile file) : folder_(std::move(folder)), file_(std::move(file)) {}
    OpenFolder folder_;
    OpenFile file_;
};

}  // namespace octoskin
