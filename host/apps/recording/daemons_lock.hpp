// The lock file of a folder of maps: while a process holds it, no daemon starts to keep its map there.
#pragma once

#include <optional>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/apps/recording/file_lock.hpp"
#include "host/io/folder/open_folder.hpp"

namespace octoskin {

/// A daemon holds a lock on this file in the folder of its maps.
inline constexpr const char* kDaemonsLock = "lock";

struct DaemonsLockFile {
    OpenFile file;  ///< not locked
    bool is_new = false;
};

/// Opens the file, and creates it if it is missing: for its owner alone, because a user who can open it can
/// hold its lock. In a folder of another user, root gives it to that user. Errors: as OpenFolder::open_file
/// and create_new.
[[nodiscard]] Result<DaemonsLockFile, FolderError> open_daemons_lock(const OpenFolder& folder);

/// Writes the process id into a lock file that has no other name, for messages of others.
void write_holder(const OpenFile& file);
/// " (process N)", if that process still exists; empty if the file names none.
[[nodiscard]] std::string holder_of(const OpenFile& file);

/// Keeps daemons from starting in a folder, while files are moved there. A daemon does not lock the folder
/// itself: every user who can read the folder could then keep it from starting.
class DaemonsKeptOut {
  public:
    /// Creates the lock file if it is missing. Empty if a daemon runs there. Where no lock file can be
    /// opened (a link, a pipe) no daemon starts. Error: the file cannot be created.
    [[nodiscard]] static Result<std::optional<DaemonsKeptOut>, FolderError> from(const OpenFolder& folder);
    DaemonsKeptOut(DaemonsKeptOut&& other) noexcept;
    DaemonsKeptOut& operator=(DaemonsKeptOut&&) = delete;
    /// Removes a lock file that was created for it, before it releases the lock.
    ~DaemonsKeptOut();

  private:
    DaemonsKeptOut(FileLock lock, std::optional<OpenFolder> made_in)
        : lock_(std::move(lock)), made_in_(std::move(made_in)) {}
    FileLock lock_;
    std::optional<OpenFolder> made_in_;
};

}  // namespace octoskin
