// A lock between processes: two octoskins that write one directory at once would mix their files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace octoskin {

/// Held on a directory or a file for as long as this lives, and given back by the system if the process dies.
/// Advisory: it keeps octoskins apart, nobody else. Two locks of one process exclude each other, too.
class FileLock {
  public:
    enum class Kind : std::uint8_t { shared, exclusive };

    /// Never waits. Empty if another holds the lock. A file system without locks, and a path that cannot be
    /// opened, give a lock that locks nothing: whatever is done there next says what is wrong with it.
    [[nodiscard]] static std::optional<FileLock> take(const std::filesystem::path& path, Kind kind);
    FileLock(FileLock&& other) noexcept;
    FileLock& operator=(FileLock&&) = delete;
    ~FileLock();

  private:
    explicit FileLock(int descriptor) : descriptor_(descriptor) {}
    int descriptor_;  ///< -1: locks nothing
};

}  // namespace octoskin
