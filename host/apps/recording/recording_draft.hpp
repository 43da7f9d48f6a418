// A recording in the making: whole in its place at the end, or not there at all.
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
    /// Makes the directory that is `named`, locks it, and makes in it a hidden folder to write into. Refuses
    /// a directory that is not empty unless it `may_replace` what is there; always one whose recording is not
    /// known to be simulated: nobody can make that again; and one that another octoskin writes or reads.
    [[nodiscard]] static Result<RecordingDraft, AppError> create(const FilePlace& named, bool may_replace);

    /// That create() would not refuse, nor commit() find anything in the place of a file that it cannot
    /// replace; but for what others do meanwhile. Changes nothing.
    [[nodiscard]] static Status<AppError> check(const FilePlace& named, bool may_replace);

    /// Where to write until then. What is not committed leaves nothing.
    [[nodiscard]] const RecordingPaths& paths() const noexcept { return draft_; }
    /// Moves the files into `directory`, in place of a former recording's files and of the maps made of it:
    /// all or none of them, see FileSet. meta.yaml comes last: where it is, the recording is whole.
    [[nodiscard]] Status<AppError> commit();

  private:
    RecordingDraft(FileSet files, std::optional<FileLock> former);

    RecordingPaths final_;
    RecordingPaths draft_;
    FileSet files_;
    std::optional<FileLock> former_;  ///< keeps readers from the recording that is replaced
};

/// Keeps a recording from being replaced while it is read. Errors: another octoskin is replacing it now
/// (bad_data).
[[nodiscard]] Result<FileLock, AppError> lock_recording(const RecordingPaths& recording);

}  // namespace octoskin
