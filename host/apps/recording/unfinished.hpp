// Folders in the making, so that they can be taken away where the process is told to end in the midst of it.
#pragma once

#include <filesystem>
#include <mutex>

namespace octoskin {

/// A folder that is removed, with all that is in it, if the process is told to end while this lives. Any
/// thread may have some.
class Unfinished {
  public:
    /// `made_for_it`: a folder that was made for it, and goes, too, if nothing else is in it; empty: none.
    explicit Unfinished(std::filesystem::path folder, std::filesystem::path made_for_it = {});
    Unfinished(Unfinished&& other) noexcept;
    Unfinished& operator=(Unfinished&&) = delete;
    ~Unfinished();

    /// It is none any more. While the lock is held nobody ends the process: what must not be done by halves
    /// is done meanwhile.
    [[nodiscard]] std::unique_lock<std::mutex> finish();

  private:
    std::filesystem::path folder_;  ///< empty: finished
    std::filesystem::path made_for_it_;
};

struct RemovedUnfinished {
    bool is_any = false;
    std::unique_lock<std::mutex> lock;  ///< whoever goes on with an unfinished folder waits for it
};

/// Removes whatever is unfinished, for a process that ends while it holds the lock. Waits for what must not
/// be done by halves.
[[nodiscard]] RemovedUnfinished remove_unfinished();

}  // namespace octoskin
