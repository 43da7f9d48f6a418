// A recording in the making: whole in its place at the end, or not there at all.
#pragma once

#include <filesystem>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/apps/recording/recording.hpp"

namespace octoskin {

class RecordingDraft {
  public:
    /// Makes `directory`, and in it a hidden folder to write into. Refuses a directory that is not empty
    /// unless it `may_replace` what is there; and always one whose recording is not known to be simulated:
    /// nobody can make that again.
    [[nodiscard]] static Result<RecordingDraft, AppError> create(const std::filesystem::path& directory,
                                                                 bool may_replace);
    RecordingDraft(RecordingDraft&& other) noexcept;
    RecordingDraft(const RecordingDraft&) = delete;
    RecordingDraft& operator=(const RecordingDraft&) = delete;
    RecordingDraft& operator=(RecordingDraft&&) = delete;
    /// Leaves nothing of what was not committed.
    ~RecordingDraft();

    /// Where to write until then.
    [[nodiscard]] const RecordingPaths& paths() const noexcept { return draft_; }
    /// Moves the files into `directory`, in place of a former recording's files and of the maps made of it.
    /// meta.yaml comes last: where it is, the recording is whole.
    [[nodiscard]] Status<AppError> commit();

  private:
    RecordingDraft(std::filesystem::path directory, bool is_new);

    RecordingPaths final_;
    RecordingPaths draft_;
    bool is_new_ = false;
    bool is_open_ = true;
};

}  // namespace octoskin
