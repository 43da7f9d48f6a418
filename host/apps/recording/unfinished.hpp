// Folders in the making, so that they can be taken away where the process is told to end in the midst of it.
#pragma once

#include <cstdint>
#include <mutex>
#include <string>

#include "host/io/folder/open_folder.hpp"

namespace octoskin {

/// A folder that is removed, with all that is in it, if the process is told to end while this lives. Any
/// thread may have some.
class Unfinished {
  public:
    /// `name`: of the folder, in `parent`. `is_parent_new`: `parent` was made for it, and goes, too, if
    /// nothing else is in it.
    Unfinished(OpenFolder parent, std::string name, bool is_parent_new = false);
    Unfinished(Unfinished&& other) noexcept;
    Unfinished& operator=(Unfinished&&) = delete;
    ~Unfinished();

    /// It is none any more. While the lock is held nobody ends the process: what must not be done by halves
    /// is done meanwhile.
    [[nodiscard]] std::unique_lock<std::mutex> finish();

  private:
    std::uint64_t number_;  ///< 0: finished
};

struct RemovedUnfinished {
    bool is_any = false;
    std::unique_lock<std::mutex> lock;  ///< whoever goes on with an unfinished folder waits for it
};

/// Removes whatever is unfinished, for a process that ends while it holds the lock. Waits for what must not
/// be done by halves.
[[nodiscard]] RemovedUnfinished remove_unfinished();

/// Removes a folder that was made, if nothing is in it and its name still leads to it.
void remove_made_folder(const OpenFolder& folder);

}  // namespace octoskin
