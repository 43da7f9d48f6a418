// A lock between processes: two octoskins that write one directory at once would mix their files.
#pragma once

#include <cstdint>
#include <optional>

#include "host/io/folder/file_place.hpp"
#include "host/io/folder/open_file.hpp"

namespace octoskin {

/// Held on a directory or a file for as long as this lives, and given back by the system if the process dies.
/// Advisory: it keeps octoskins apart, nobody else. Two locks of one process exclude each other, too.
class FileLock {
  public:
    enum class Kind : std::uint8_t { shared, exclusive };

    /// Never waits. Empty if another holds the lock. A file system without locks, and what cannot be
    /// opened, give a lock that locks nothing: whatever is done there next says what is wrong with it.
    [[nodiscard]] static std::optional<FileLock> take(const FilePlace& file, Kind kind);
    [[nodiscard]] static std::optional<FileLock> take(const OpenFolder& folder, Kind kind);
    /// The same, exclusive, of `opened`, which was at `file` and is removed before it is given back: empty
    /// also where another removed or replaced it before it was locked.
    [[nodiscard]] static std::optional<FileLock> take(OpenFile opened, const FilePlace& file);
    [[nodiscard]] static FileLock of_nothing() { return FileLock(Descriptor()); }

  private:
    explicit FileLock(Descriptor descriptor) : descriptor_(std::move(descriptor)) {}
    [[nodiscard]] static std::optional<FileLock> lock(Descriptor descriptor, Kind kind);
    /// It may have been replaced, or removed, before it was locked.
    [[nodiscard]] bool is_of(const FilePlace& file) const;
    Descriptor descriptor_;  ///< none: locks nothing
};

}  // namespace octoskin
