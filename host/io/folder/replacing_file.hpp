// A file that replaces another one when it is complete. It is written under a temporary name beside it and
// then renamed, so that links are not followed and an incomplete file is never visible.
#pragma once

#include <optional>
#include <string>

#include "common/result.hpp"
#include "host/io/folder/file_place.hpp"

namespace octoskin {

class ReplacingFile {
  public:
    /// Checks that `file` can be created: its folder belongs to the caller or root and is writable, and at
    /// the name of the file there is nothing, a regular file or a link. Changes nothing. Errors: is_there
    /// (something else at that name, or at the temporary name); as FilePlace::parent_to_write; not_permitted.
    [[nodiscard]] static Status<FolderError> check(const FilePlace& file);
    /// Creates a new, empty temporary file beside `file`. If `file` is a regular file of the caller's, it
    /// gets the same mode. Errors: as check().
    [[nodiscard]] static Result<ReplacingFile, FolderError> begin(const FilePlace& file);
    ReplacingFile(ReplacingFile&& other) noexcept = default;
    ReplacingFile& operator=(ReplacingFile&&) = delete;
    /// Removes the temporary file if it was not committed.
    ~ReplacingFile();

    [[nodiscard]] int descriptor() const noexcept { return file_->descriptor(); }
    /// Closes the file and renames it into place. A link there is replaced, not followed; other hard links of
    /// the old file stay unchanged. Errors: those of close(2) and rename(2).
    [[nodiscard]] Status<FolderError> commit();

  private:
    ReplacingFile(OpenFolder folder, std::string name, OpenFile file);

    OpenFolder folder_;
    std::string name_;
    std::optional<OpenFile> file_;  ///< empty after commit()
};

}  // namespace octoskin
