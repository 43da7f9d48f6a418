// An ordinary file that has been opened: what is read is this file, whatever becomes of its name.
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
    /// As the user named it: for messages, never to be opened.
    [[nodiscard]] const std::filesystem::path& shown() const noexcept { return shown_; }
    /// For what wants a path: leads to this very file as long as this is open, in this process.
    [[nodiscard]] std::filesystem::path path_for_libraries() const;
    /// The same for a process that this one starts and outlives.
    [[nodiscard]] std::filesystem::path path_for_helpers() const;

    /// Its bytes, `bytes_max` + 1 at most: more than bytes_max are too many. Error: the system's.
    [[nodiscard]] Result<std::string, FolderError> read(std::size_t bytes_max) const;

  private:
    Descriptor descriptor_;
    std::filesystem::path shown_;
};

/// Opens for reading what O_PATH has opened, if it is an ordinary file: to open a device or a pipe may
/// already do something, or wait for ever. Error: not_a_file, naming what it is, a file of over 1 GiB that is
/// nearly all holes among them; the system's.
[[nodiscard]] Result<OpenFile, FolderError> open_ordinary(const Descriptor& path,
                                                          const std::filesystem::path& shown);

/// "a named pipe", "a directory", ...; empty: an ordinary file. `mode` as in stat.
[[nodiscard]] std::string other_kind_of(unsigned mode);

/// "/proc/self/fd/N".
[[nodiscard]] std::filesystem::path path_of_descriptor(int descriptor);

}  // namespace octoskin
