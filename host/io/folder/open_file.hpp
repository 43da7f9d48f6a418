// An open regular file: this file is read, even if its name changes meanwhile.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <utility>

#include "common/result.hpp"
#include "host/io/folder/beneath.hpp"
#include "host/io/folder/descriptor.hpp"
#include "host/io/folder/folder_error.hpp"

namespace octoskin {

class OpenFile {
  public:
    OpenFile(Descriptor descriptor, std::filesystem::path shown)
        : descriptor_(std::move(descriptor)), shown_(std::move(shown)) {}

    [[nodiscard]] int descriptor() const noexcept { return descriptor_.get(); }
    /// The caller closes it.
    [[nodiscard]] int release() noexcept { return descriptor_.release(); }
    /// The path as the user named it: for messages, never for opening.
    [[nodiscard]] const std::filesystem::path& shown() const noexcept { return shown_; }
    /// A path for libraries: it leads to this file while this object is open, in this process.
    [[nodiscard]] std::filesystem::path path_for_libraries() const;
    /// The same for a child process that does not outlive this one.
    [[nodiscard]] std::filesystem::path path_for_helpers() const;

    /// The file's content, at most `bytes_max` + 1 bytes; a longer result means that the file is too large.
    /// Error: of the system.
    [[nodiscard]] Result<std::string, FolderError> read(std::size_t bytes_max) const;

  private:
    Descriptor descriptor_;
    std::filesystem::path shown_;
};

/// Opens for reading what `path` (O_PATH) refers to, if it is a regular file. Opening a device or a pipe may
/// have an effect, or block forever. Errors: not_a_file with its kind, also for a file over 1 GiB that
/// consists almost only of holes; those of the system.
[[nodiscard]] Result<OpenFile, FolderError> open_ordinary(const Descriptor& path,
                                                          const std::filesystem::path& shown);

/// "a named pipe", "a directory", ...; empty for a regular file. `mode` as in stat.
[[nodiscard]] std::string other_kind_of(unsigned mode);

/// "/proc/self/fd/N".
[[nodiscard]] std::filesystem::path path_of_descriptor(int descriptor);

}  // namespace octoskin
