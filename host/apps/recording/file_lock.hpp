// A lock between processes: two octoskin processes that write one directory at once would mix their files.
#pragma once

#include <cstdint>
#include <optional>

#include "host/io/folder/file_place.hpp"
#include "host/io/folder/open_file.hpp"

namespace octoskin {

/// A lock on a directory or a file for the lifetime of this object; the system releases it if the process
/// dies. Advisory: it excludes other octoskin processes only. Two locks of one process exclude each other,
/// too.
class FileLock {
  public:
    enum class Kind : std::uint8_t { shared, exclusive };

    /// Never waits. Empty if another process holds the lock. If the file system has no locks, or the file
    /// cannot be opened, the result is a lock without effect: the next access reports the error.
    [[nodiscard]] static std::optional<FileLock> take(const FilePlace& file, Kind kind);
    [[nodiscard]] static std::optional<FileLock> take(const OpenFolder& folder, Kind kind);
    /// As above, exclusive, for `opened`, which was at `file` and is removed before the lock is released.
    /// Empty also if another process removed or replaced it before it was locked.
    [[nodiscard]] static std::optional<FileLock> take(OpenFile opened, const FilePlace& file);
    [[nodiscard]] static FileLock of_nothing() { return FileLock(Descriptor()); }

  private:
    explicit FileLock(Descriptor descriptor) : descriptor_(std::move(descriptor)) {}
    [[nodiscard]] static std::optional<FileLock> lock(Descriptor descriptor, Kind kind);
    /// False if the file was replaced or removed before it was locked.
    [[nodiscard]] bool is_of(const FilePlace& file) const;
    Descriptor descriptor_;  ///< none: a lock without effect
};

}  // namespace octoskin
