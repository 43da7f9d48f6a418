// A recording while it is made: at the end it is complete in its place, or absent.
#pragma once

#include <filesystem>
#include <optional>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/apps/recording/file_lock.hpp"
#include "host/apps/recording/file_set.hpp"
#include "host/apps/recording/recording.hpp"

namespace octoskin {

class RecordingDraft {
  public:
    /// Creates the directory `named`, locks it, and creates a hidden folder in it to write into. Errors: a
    /// directory that is not empty, unless it `may_replace` the content; in any case a recording that is not
    /// known to be simulated, because it cannot be made again; a directory that another octoskin writes or
    /// reads.
    [[nodiscard]] static Result<RecordingDraft, AppError> create(const FilePlace& named, bool may_replace);

    /// Checks that create() would succeed and that commit() could replace every existing file, unless other
    /// processes interfere meanwhile. Changes nothing.
    [[nodiscard]] static Status<AppError> check(const FilePlace& named, bool may_replace);

    /// The places to write to before commit(). Without a commit nothing remains.
    [[nodiscard]] const RecordingPaths& paths() const noexcept { return draft_; }
    /// Moves the files into `directory`, in place of a previous recording's files and of the maps made from
    /// it: all or none, see FileSet. meta.yaml comes last: where it exists, the recording is complete.
    [[nodiscard]] Status<AppError> commit();

  private:
    RecordingDraft(FileSet files, std::optional<FileLock> former);

    RecordingPaths final_;
    RecordingPaths draft_;
    FileSet files_;
    std::optional<FileLock> former_;  ///< keeps readers out of the recording that is replaced
};

/// Keeps a recording from being replaced while it is read. Error (bad_data): another octoskin is replacing it
/// now.
[[nodiscard]] Result<FileLock, AppError> lock_recording(const RecordingPaths& recording);

}  // namespace octoskin
