// Files that come into a folder together: all of them or none, whatever fails or is killed on the way.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/apps/recording/file_lock.hpp"
#include "host/apps/recording/unfinished.hpp"

namespace octoskin {

/// They are written into a hidden folder beside their places. `commit` flushes them to the disk, renames that
/// folder, which is the one step that decides, and then moves file after file. An error on the way undoes
/// what was moved. If the process dies on the way, the next one that opens the folder goes on to the end.
class FileSet {
  public:
    /// Makes `folder` if it is not there, locks it against other octoskins, ends or clears away what a killed
    /// one left, and makes the hidden folder. Errors (cannot_create): another octoskin at work there; the
    /// file system's.
    [[nodiscard]] static Result<FileSet, AppError> begin(const std::filesystem::path& folder);
    FileSet(FileSet&& other) noexcept;
    FileSet& operator=(FileSet&&) = delete;
    /// Leaves nothing of what was not committed, nor a folder that was made for it; nor does a process that
    /// is told to end (Unfinished).
    ~FileSet();

    /// Where to write until then.
    [[nodiscard]] const std::filesystem::path& draft() const noexcept { return draft_; }
    [[nodiscard]] const std::filesystem::path& folder() const noexcept { return folder_; }
    [[nodiscard]] bool is_new() const noexcept { return is_new_; }

    /// Puts `files`, names in the draft, in their places and removes `retired`, paths relative to the folder
    /// that may lead to nothing. The last of `files` vouches for all: where it is, the others are whole and
    /// belong to it; it is the first to go and the last to come. On an error (cannot_create; what is no file
    /// lies in a place) the folder is as it was. Asserts at least one file.
    [[nodiscard]] Status<AppError> commit(const std::vector<std::filesystem::path>& files,
                                          const std::vector<std::filesystem::path>& retired);

    /// The hidden folder's name: for those who ask whether a folder is empty.
    static constexpr const char* kDraftFolder = ".octoskin-part";

  private:
    FileSet(std::filesystem::path folder, bool is_new, FileLock lock);

    std::filesystem::path folder_;
    std::filesystem::path draft_;
    bool is_new_;
    bool is_open_ = true;
    Unfinished unfinished_;
    FileLock lock_;
};

/// To be called before the files of a folder are read: ends what a process left that was killed while it put
/// them in place. Does nothing in every other folder. Errors: another octoskin is putting them in place now;
/// the file system's.
[[nodiscard]] Status<AppError> settle_file_set(const std::filesystem::path& folder);

}  // namespace octoskin
