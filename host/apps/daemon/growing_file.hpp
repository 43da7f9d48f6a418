// A new file that only grows: what is recorded as it comes.
#pragma once

#include <filesystem>
#include <string>

#include "common/result.hpp"
#include "host/io/folder/file_place.hpp"

namespace octoskin {

/// A new file that only grows. Errors say what failed and why ("out/can.log: No space left on device").
class GrowingFile {
  public:
    GrowingFile() = default;
    GrowingFile(const GrowingFile&) = delete;
    GrowingFile& operator=(const GrowingFile&) = delete;
    ~GrowingFile();
    /// Refuses one that is there already.
    [[nodiscard]] Status<std::string> create(const FilePlace& file);
    [[nodiscard]] Status<std::string> append(const std::string& text);
    /// To the disk, and closed.
    [[nodiscard]] Status<std::string> finish();

  private:
    [[nodiscard]] Unexpected<std::string> failure() const;
    std::filesystem::path file_;
    int descriptor_ = -1;
};

}  // namespace octoskin
