// A file in memory, without a name: for bytes that nothing outside this process may change.
#pragma once

#include <filesystem>
#include <string_view>

#include "common/result.hpp"
#include "host/io/folder/folder_error.hpp"
#include "host/io/folder/open_file.hpp"

namespace octoskin {

class MemoryFile {
  public:
    /// `shown`: the name for messages. Error: of the system.
    [[nodiscard]] static Result<MemoryFile, FolderError> make(std::filesystem::path shown);

    /// Appends. False, with errno, if there is no room.
    [[nodiscard]] bool write(std::string_view bytes);
    /// The file, to be read from its begin.
    [[nodiscard]] Result<OpenFile, FolderError> opened() &&;

  private:
    explicit MemoryFile(OpenFile file) : file_(std::move(file)) {}
    OpenFile file_;
};

}  // namespace octoskin
