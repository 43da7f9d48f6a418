// Registers unfinished folders, so that they are removed if a signal ends the process.
#pragma once

#include <cstdint>
#include <mutex>
#include <string>

#include "host/io/folder/open_folder.hpp"

namespace octoskin {

/// A folder that is removed with its content if a signal ends the process during the lifetime of this object.
/// Any thread may have several.
class Unfinished {
  public:
    /// `name`: of the folder in `parent`. `is_parent_new`: `parent` was created for it, and is removed, too,
    /// if it is otherwise empty.
    Unfinished(OpenFolder parent, std::string name, bool is_parent_new = false);
    Unfinished(Unfinished&& other) noexcept;
    Unfinished& operator=(Unfinished&&) = delete;
    ~Unfinished();

    /// The folder is finished. While the returned lock is held, a signal does not end the process: use it for
    /// steps that must not be interrupted.
    [[nodiscard]] std::unique_lock<std::mutex> finish();

  private:
    std::uint64_t number_;  ///< 0: finished
};

struct RemovedUnfinished {
    bool is_any = false;
    std::unique_lock<std::mutex> lock;  ///< a thread that continues with an unfinished folder waits for it
};

/// Removes all unfinished folders, for a process that then ends while it holds the lock. Waits for steps that
/// must not be interrupted.
[[nodiscard]] RemovedUnfinished remove_unfinished();

/// Removes a folder that this program created, if it is empty and its name still leads to it.
void remove_made_folder(const OpenFolder& folder);

}  // namespace octoskin
