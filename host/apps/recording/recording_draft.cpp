#include "host/apps/recording/recording_draft.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace octoskin {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDraftFolder = ".octoskin-part";

Unexpected<AppError> fail(const fs::path& place, const std::string& what) {
    return unexpected(AppError{ExitCode::cannot_create, place.string() + ": " + what});
}

/// meta.yaml last.
std::vector<fs::path> files_of(const RecordingPaths& paths) {
    return {paths.can_log(), paths.depth(), paths.depth_epoch(), paths.rig(), paths.robot(), paths.meta()};
}

bool is_occupied(const fs::path& directory) {
    std::error_code error;
    const fs::directory_iterator entries(directory, error);
    return !error && std::any_of(begin(entries), end(entries),
                                 [](const auto& entry) { return entry.path().filename() != kDraftFolder; });
}

Status<AppError> check_replaceable(const RecordingPaths& paths) {
    const auto files = files_of(paths);
    const auto is_there = [](const fs::path& file) {
        std::error_code error;
        return fs::exists(file, error);
    };
    const auto first = std::find_if(files.begin(), files.end(), is_there);
    if (first == files.end()) return Done{};
    const auto meta = read_meta(paths);
    if (meta && meta->is_simulated()) return Done{};
    return fail(paths.directory, "has a " + first->filename().string() +
                                     ", and no meta.yaml that says 'source: simulation': it is not "
                                     "overwritten; give another directory, or remove it yourself");
}

/// What replay made of a former recording.
void remove_maps(const fs::path& folder) {
    std::error_code ignored;
    for (const char* name : {"depth", "proximity", "fused"}) {
        for (const char* extension : {".ot", ".bt", ".ply"}) {
            fs::remove(folder / (std::string(name) + extension), ignored);
        }
    }
    if (fs::is_empty(folder, ignored)) fs::remove(folder, ignored);
}

}  // namespace

RecordingDraft::RecordingDraft(fs::path directory, bool is_new)
    : final_(directory), draft_(directory / kDraftFolder), is_new_(is_new) {}

RecordingDraft::RecordingDraft(RecordingDraft&& other) noexcept
    : final_(std::move(other.final_)),
      draft_(std::move(other.draft_)),
      is_new_(other.is_new_),
      is_open_(std::exchange(other.is_open_, false)) {}

RecordingDraft::~RecordingDraft() {
    if (!is_open_) return;
    std::error_code ignored;
    fs::remove_all(draft_.directory, ignored);
    if (is_new_) fs::remove(final_.directory, ignored);  // only if it is empty
}

Result<RecordingDraft, AppError> RecordingDraft::create(const fs::path& directory, bool may_replace) {
    if (is_occupied(directory)) {
        if (!may_replace) {
            return fail(directory,
                        "is not empty; give another directory, or --force to replace a simulated recording");
        }
        if (const auto checked = check_replaceable(RecordingPaths(directory)); !checked) {
            return unexpected(checked.error());
        }
    }
    std::error_code error;
    const bool is_new = fs::create_directories(directory, error);
    if (error) return fail(directory, error.message());
    RecordingDraft draft(directory, is_new);
    fs::remove_all(draft.draft_.directory, error);  // of a process that was killed
    fs::create_directory(draft.draft_.directory, error);
    if (error) return fail(directory, error.message());
    return draft;
}

Status<AppError> RecordingDraft::commit() {
    std::error_code error;
    // create() made sure that a recording here is a simulated one; without one, its maps are somebody's.
    const bool replaces_recording = fs::remove(final_.meta(), error);
    const auto from = files_of(draft_);
    const auto to = files_of(final_);
    for (std::size_t i = 0; i < from.size(); ++i) {
        if (fs::exists(from[i], error)) {
            fs::rename(from[i], to[i], error);
        } else {
            fs::remove(to[i], error);
        }
        if (error) return fail(to[i], error.message());
    }
    if (replaces_recording) remove_maps(final_.directory / "maps");
    fs::remove_all(draft_.directory, error);
    is_open_ = false;
    return Done{};
}

}  // namespace octoskin
