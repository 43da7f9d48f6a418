// A file that takes the place of another one when it is whole: it is written under another name beside it and
// then renamed, so that no link is written through and no half of a file is ever seen.
#pragma once

#include <optional>
#include <string>

#include "common/result.hpp"
#include "host/io/folder/file_place.hpp"

namespace octoskin {

class ReplacingFile {
  public:
    /// That `file` can be made: its folder is the caller's or root's and may be written, and in the place of
    /// the file nothing, an ordinary file or a link lies. Changes nothing. Errors: is_there (something else
    /// is in that place, or in that of the file beside it); as FilePlace::parent_to_write; not_permitted.
    [[nodiscard]] static Status<FolderError> check(const FilePlace& file);
    /// A new, empty file beside `file`, with the mode of an ordinary file of the caller's that is to be
    /// replaced. Errors: as check().
    [[nodiscard]] static Result<ReplacingFile, FolderError> begin(const FilePlace& file);
    ReplacingFile(ReplacingFile&& other) noexcept = default;
    ReplacingFile& operator=(ReplacingFile&&) = delete;
    /// Removes what did not come into its place.
    ~ReplacingFile();

    [[nodiscard]] int descriptor() const noexcept { return file_->descriptor(); }
    /// Closes it and puts it into its place. A link there is replaced, not followed; of a file with several
    /// names the others stay as they are. Errors: those of close(2) and rename(2).
    [[nodiscard]] Status<FolderError> commit();

  private:
    ReplacingFile(OpenFolder folder, std::string name, OpenFile file);

    OpenFolder folder_;
    std::string name_;
    std::optional<OpenFile> file_;  ///< none once it is in its place
};

}  // namespace octoskin
