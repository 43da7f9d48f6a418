// The folder in which the daemon saves its maps, held open and locked, even if its name changes.
#pragma once

#include <filesystem>
#include <string>
#include <utility>

#include "common/result.hpp"
#include "host/apps/daemon/folder_lock.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/io/folder/open_folder.hpp"

namespace octoskin {

/// A folder that is removed, moved or replaced while a daemon runs is not the one it holds. Maps are never
/// saved by name: only into the held folder, or into one that took its place, once that is locked and if it
/// has no map of its own. Links in the given name are followed once, at the start. From then on the place is
/// their target, and a link there, or on the way there, is not followed.
class MapHome {
  public:
    /// Creates the folder if it is missing. Errors as for FolderLock::take.
    [[nodiscard]] static Result<MapHome, AppError> take(const std::filesystem::path& named);

    [[nodiscard]] const OpenFolder& folder() const noexcept { return lock_.folder(); }

    /// Checks that the folder is still in its place. If not, and a folder without a map has taken it, that
    /// one is held from now on: returns true.
    [[nodiscard]] bool look();
    /// Where the folder is now; empty if it was removed.
    [[nodiscard]] std::string where() const;
    /// The problem at the last check, with the remedy; empty: none.
    [[nodiscard]] const std::string& problem() const noexcept { return problem_; }

  private:
    MapHome(std::filesystem::path named, FolderLock lock);
    [[nodiscard]] bool is_in_its_place() const;
    [[nodiscard]] std::string why_not_there() const;
    [[nodiscard]] std::string why_not_overwritten() const;
    /// Where the map is saved meanwhile, for messages.
    [[nodiscard]] std::string where_it_goes() const;

    std::filesystem::path named_;
    FolderLock lock_;
    std::filesystem::path place_;  ///< absolute, and without a link at the start
    std::string problem_;
};

}  // namespace octoskin
