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
/// ever saved by name: into the folder that is held, or into one that took its place, once that is locked,
/// and only if it has no map of its own. Links in the name that was typed are followed once, at the start;
/// from then on the place is where they led, and a link there, or on the way there, is not followed.
class MapHome {
  public:
    /// Makes the folder if it is not there. Errors: as FolderLock::take.
    [[nodiscard]] static Result<MapHome, AppError> take(const std::filesystem::path& named);

    [[nodiscard]] const OpenFolder& folder() const noexcept { return lock_.folder(); }

    /// Looks whether the folder is still in its place. If not, and a folder without a map has taken it, that
    /// one is held from now on: true.
    [[nodiscard]] bool look();
    /// Where the folder is now; empty if it was removed.
    [[nodiscard]] std::string where() const;
    /// What was wrong at the last look, and what to do; empty: nothing.
    [[nodiscard]] const std::string& problem() const noexcept { return problem_; }

  private:
    MapHome(std::filesystem::path named, FolderLock lock);
    [[nodiscard]] bool is_in_its_place() const;
    [[nodiscard]] std::string why_not_there() const;
    /// What becomes of the map meanwhile.
    [[nodiscard]] std::string where_it_goes() const;

    std::filesystem::path named_;
    FolderLock lock_;
    std::filesystem::path place_;  ///< absolute, and without a link when the folder was taken
    std::string problem_;
};

}  // namespace octoskin
