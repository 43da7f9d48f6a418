// A new file of any size, written piece by piece: at the end it is in its place, or absent.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/apps/recording/unfinished.hpp"
#include "host/io/folder/file_place.hpp"

namespace octoskin::bridge {

class OutputFile {
  public:
    /// Begins a hidden file beside `file`. Errors (cannot_create): the file exists, unless it `may_replace`
    /// it; a folder that does not exist, belongs to another user or may not be written to.
    [[nodiscard]] static Result<OutputFile, AppError> begin(const FilePlace& file, bool may_replace);
    OutputFile(OutputFile&&) noexcept = default;
    OutputFile& operator=(OutputFile&&) = delete;
    /// Without `commit` nothing remains; nor if a signal ends the process (Interruption).
    ~OutputFile();

    /// False: the system refused it, and `commit` says why.
    [[nodiscard]] bool write(std::string_view bytes);
    /// Flushes the file to the disk and renames it. Error (cannot_create): of the system.
    [[nodiscard]] Status<AppError> commit();

  private:
    OutputFile(OpenFolder folder, std::string name, OpenFile file);
    [[nodiscard]] Unexpected<AppError> failure(int error_number) const;

    OpenFolder folder_;
    std::string name_;
    std::optional<OpenFile> file_;  ///< empty after commit
    std::optional<Unfinished> unfinished_;
    int error_number_ = 0;
};

}  // namespace octoskin::bridge
