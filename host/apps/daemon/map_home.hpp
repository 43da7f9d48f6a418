// Where the daemon keeps its maps: the folder itself, held open and locked, whatever becomes of its name.
#pragma once

#include <filesystem>
#include <string>
#include <utility>

#include "common/result.hpp"
#include "host/apps/daemon/folder_lock.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/io/folder/open_folder.hpp"

namespace octoskin {

/// A folder that is removed, moved or replaced while a daemon runs is another one than it holds. Nothing is
/// ever saved by name: into the folder that is held, or into one that took its name, once that is locked, and
/// only if it has no map of its own.
class MapHome {
  public:
    /// Makes the folder if it is not there. Errors: as FolderLock::take.
    [[nodiscard]] static Result<MapHome, AppError> take(const std::filesystem::path& named);

    [[nodiscard]] const OpenFolder& folder() const noexcept { return lock_.folder(); }

    /// Looks whether the name still leads to the folder. If not, and a folder without a map has taken its
    /// name, that one is held from now on: true.
    [[nodiscard]] bool look();
    /// What was wrong at the last look, and what to do; empty: nothing.
    [[nodiscard]] const std::string& problem() const noexcept { return problem_; }

  private:
    MapHome(std::filesystem::path named, FolderLock lock)
        : named_(std::move(named)), lock_(std::move(lock)) {}
    [[nodiscard]] std::string why_not_there() const;

    std::filesystem::path named_;
    FolderLock lock_;
    std::string problem_;
};

}  // namespace octoskin
