// A set of files that is put into a folder as a whole: all of them or none, even if a step fails or the
// process is killed.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/apps/recording/daemons_lock.hpp"
#include "host/apps/recording/file_lock.hpp"
#include "host/apps/recording/unfinished.hpp"

namespace octoskin {

/// The whole state of a daemon's map; only a daemon writes it.
inline constexpr const char* kDaemonsSnapshot = "fused.snapshot";

/// The files are written into a hidden folder beside their final places. `commit` flushes them to the disk
/// and renames that folder, which is the decisive step; then it moves file after file. An error undoes the
/// moves. If the process dies, the next writer of the folder, or the next daemon, completes the moves;
/// readers refuse the folder meanwhile. No daemon starts there while files are moved. Everything happens
/// below one descriptor, without following links, and only with names that is_file_of_set() accepts. The
/// folder of the depth frames of named cameras is created and removed with its files.
class FileSet {
  public:
    /// Creates `folder` if it does not exist, locks it against other octoskin processes, completes or removes
    /// the remains of a killed one, and creates the hidden folder. Errors (cannot_create): another octoskin
    /// is working there; the maps of a daemon, which only a daemon replaces; a folder of another user or,
    /// below a named one, a link (FilePlace); errors of the file system.
    [[nodiscard]] static Result<FileSet, AppError> begin(const FilePlace& folder);
    FileSet(FileSet&& other) noexcept;
    FileSet& operator=(FileSet&&) = delete;
    /// Removes everything that was not committed, and a folder that was created for it. A process that ends
    /// by a signal does the same (Unfinished).
    ~FileSet();

    /// The folder to write into before `commit`.
    [[nodiscard]] const OpenFolder& draft() const noexcept { return draft_; }
    [[nodiscard]] const OpenFolder& folder() const noexcept { return folder_; }
    [[nodiscard]] bool is_new() const noexcept { return is_new_; }

    /// Puts `files`, names in the draft, into their places and removes `retired`, paths relative to the
    /// folder that need not exist. The last of `files` marks the set as complete: where it exists, the others
    /// are complete and belong to it; it is removed first and put last.
    /// On an error (cannot_create; something other than a file is in a place, or a daemon has begun to keep
    /// its maps there) the folder is unchanged. Asserts at least one file, and is_file_of_set() for each.
    [[nodiscard]] Status<AppError> commit(const std::vector<std::filesystem::path>& files,
                                          const std::vector<std::filesystem::path>& retired);

    /// Checks that each of `names` is free, or a file that commit() can replace; for the folder of depth
    /// frames and its files, that this is a folder if it exists. Error (cannot_create): the obstacle.
    [[nodiscard]] static Status<AppError> check_places(const OpenFolder& folder,
                                                       const std::vector<std::filesystem::path>& names);

    /// The name of the hidden folder, for checks whether a folder is empty.
    static constexpr const char* kDraftFolder = ".octoskin-part";
    /// The name of the hidden folder after the decision. Where it exists, a process was killed or is still at
    /// work.
    static constexpr const char* kReadyFolder = ".octoskin-ready";

  private:
    FileSet(OpenFolder folder, OpenFolder draft, bool is_new, Unfinished unfinished, FileLock lock);
    void discard();

    OpenFolder folder_;
    OpenFolder draft_;
    bool is_new_;
    bool is_open_ = true;
    Unfinished unfinished_;
    FileLock lock_;  ///< of the folder
};

/// Whether a recording uses this name for a mesh of its world: mesh_01.stl.
[[nodiscard]] bool is_scene_mesh(std::string_view name);

/// Whether a rig's camera can have this name, and files can be named after it.
[[nodiscard]] bool is_camera_name(std::string_view name);
/// "left" for "left.oni" and "left.epoch.yaml", names in the folder of depth frames. Empty: not such a name.
[[nodiscard]] std::string camera_of_file(std::string_view name);

/// Whether octoskin may write this name into a folder or remove it: a recording's files, also those in
/// "depth/", and maps, also in "maps/".
[[nodiscard]] bool is_file_of_set(const std::filesystem::path& name);

/// Completes the remains of a process that was killed while it moved files into place; true if there were
/// any. Errors (cannot_create): another octoskin is working there; the files wait beside a daemon's map; a
/// folder of another user; errors of the file system.
[[nodiscard]] Result<bool, AppError> settle_file_set(const OpenFolder& folder);
/// The same for a daemon that holds kDaemonsLock there, before it reads its map.
[[nodiscard]] Result<bool, AppError> settle_file_set_of_daemon(const OpenFolder& folder);

}  // namespace octoskin
