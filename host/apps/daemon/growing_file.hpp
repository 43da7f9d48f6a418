// A new file that only grows, for recordings.
#pragma once

#include <filesystem>
#include <string>

#include "common/result.hpp"
#include "host/io/folder/file_place.hpp"

namespace octoskin {

/// A new file that only grows. Errors contain the file and the reason ("out/can.log: No space left on
/// device").
class GrowingFile {
  public:
    GrowingFile() = default;
    GrowingFile(const GrowingFile&) = delete;
    GrowingFile& operator=(const GrowingFile&) = delete;
    ~GrowingFile();
    /// Refuses an existing file.
    [[nodiscard]] Status<std::string> create(const FilePlace& file);
    [[nodiscard]] Status<std::string> append(const std::string& text);
    /// Error: the file was removed. Its content is lost when it is closed.
    [[nodiscard]] Status<std::string> check() const;
    /// Writes it to the disk and closes it.
    [[nodiscard]] Status<std::string> finish();

  private:
    [[nodiscard]] Unexpected<std::string> failure() const;
    std::filesystem::path file_;
    int descriptor_ = -1;
};

}  // namespace octoskin
