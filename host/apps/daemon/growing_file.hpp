// A new file that only grows, for recordings.
#pragma once

#include <filesystem>
#include <string>

#include "common/result.hpp"
#include "host/errors/error.hpp"
#include "host/io/folder/file_place.hpp"

namespace octoskin {

/// A new file that only grows. Errors contain the file.
class GrowingFile {
  public:
    GrowingFile() = default;
    GrowingFile(const GrowingFile&) = delete;
    GrowingFile& operator=(const GrowingFile&) = delete;
    ~GrowingFile();
    /// Refuses an existing file.
    [[nodiscard]] Status<Error> create(const FilePlace& file);
    [[nodiscard]] Status<Error> append(const std::string& text);
    /// Error: the file was removed. Its content is lost when it is closed.
    [[nodiscard]] Status<Error> check() const;
    /// Writes it to the disk and closes it.
    [[nodiscard]] Status<Error> finish();

  private:
    [[nodiscard]] Unexpected<Error> failure() const;
    std::filesystem::path file_;
    int descriptor_ = -1;
};

}  // namespace octoskin
