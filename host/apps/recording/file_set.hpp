// Files that come into a folder together: all of them or none, whatever fails or is killed on the way.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/apps/recording/file_lock.hpp"
#include "host/apps/recording/unfinished.hpp"

namespace octoskin {

/// A daemon holds this file of the folder of its maps.
inline constexpr const char* kDaemonsLock = "lock";
/// Its map in full, which only a daemon writes.
inline constexpr const char* kDaemonsSnapshot = "fused.snapshot";

/// They are written into a hidden folder beside their places. `commit` flushes them to the disk, renames that
/// folder, which is the one step that decides, and then moves file after file. An error on the way undoes
/// what was moved. If the process dies on the way, the next one that writes to the folder goes on to the end;
/// what only reads refuses it. All of it below one descriptor, behind no link, and with names of a fixed list
/// alone.
class FileSet {
  public:
    /// Makes `folder` if it is not there, locks it against other octoskins, ends or clears away what a killed
    /// one left, and makes the hidden folder. Errors (cannot_create): another octoskin at work there; a
    /// daemon's maps, which nothing but a daemon replaces; a folder of somebody else or, below a named one, a
    /// link (FilePlace); the file system's.
    [[nodiscard]] static Result<FileSet, AppError> begin(const FilePlace& folder);
    FileSet(FileSet&& other) noexcept;
    FileSet& operator=(FileSet&&) = delete;
    /// Leaves nothing of what was not committed, nor a folder that was made for it; nor does a process that
    /// is told to end (Unfinished).
    ~FileSet();

    /// Where to write until then.
    [[nodiscard]] const OpenFolder& draft() const noexcept { return draft_; }
    [[nodiscard]] const OpenFolder& folder() const noexcept { return folder_; }
    [[nodiscard]] bool is_new() const noexcept { return is_new_; }

    /// Puts `files`, names in the draft, in their places and removes `retired`, paths relative to the folder
    /// that may lead to nothing. The last of `files` vouches for all: where it is, the others are whole and
    /// belong to it; it is the first to go and the last to come. On an error (cannot_create; what is no file
    /// lies in a place, or a daemon has begun to keep its maps there) the folder is as it was. Asserts at
    /// least one file, and is_file_of_set() of each.
    [[nodiscard]] Status<AppError> commit(const std::vector<std::filesystem::path>& files,
                                          const std::vector<std::filesystem::path>& retired);

    /// That commit() would find each of `names` free or taken by a file that it can replace. Error
    /// (cannot_create): what is in the way.
    [[nodiscard]] static Status<AppError> check_places(const OpenFolder& folder,
                                                       const std::vector<std::filesystem::path>& names);

    /// The hidden folder's name: for those who ask whether a folder is empty.
    static constexpr const char* kDraftFolder = ".octoskin-part";
    /// The same once it is decided that its files come: where it is, a process was killed, or is at it.
    static constexpr const char* kReadyFolder = ".octoskin-ready";

  private:
    FileSet(OpenFolder folder, OpenFolder draft, bool is_new, Unfinished unfinished, FileLock lock);

    OpenFolder folder_;
    OpenFolder draft_;
    bool is_new_;
    bool is_open_ = true;
    Unfinished unfinished_;
    FileLock lock_;  ///< of the folder
};

/// Whether a recording names a mesh of its world so: mesh_01.stl.
[[nodiscard]] bool is_scene_mesh(std::string_view name);

/// A name that octoskin may put into a folder or retire from it: a recording's files, and maps, also in
/// "maps/".
[[nodiscard]] bool is_file_of_set(const std::filesystem::path& name);

/// Ends what a process left that was killed while it put files in place; true if there was something. Errors
/// (cannot_create): another octoskin is at work there; a folder of somebody else; the file system's.
[[nodiscard]] Result<bool, AppError> settle_file_set(const OpenFolder& folder);

}  // namespace octoskin
