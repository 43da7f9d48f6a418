#include "host/apps/recording/recording_draft.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace octoskin {
namespace {

namespace fs = std::filesystem;

/// Of the named ones.
std::vector<FilePlace> files_of_cameras(const RecordingPaths& paths) {
    std::vector<FilePlace> files;
    for (const std::string& camera : paths.cameras()) {
        if (camera.empty()) continue;
        files.push_back(paths.depth(camera));
        files.push_back(paths.depth_epoch(camera));
    }
    return files;
}

/// meta.yaml is the last.
std::vector<FilePlace> files_of(const RecordingPaths& paths) {
    std::vector<FilePlace> files{paths.can_log(), paths.depth(),    paths.depth_epoch(), paths.rig(),
                                 paths.robot(),   paths.scenario(), paths.world(),       paths.motion()};
    for (FilePlace& file : files_of_cameras(paths)) files.push_back(std::move(file));
    for (FilePlace& mesh : paths.meshes()) files.push_back(std::move(mesh));
    files.push_back(paths.meta());
    return files;
}

/// Apart from what a killed octoskin can leave.
bool is_occupied(const OpenFolder& folder) {
    const auto names = folder.names();
    return names && std::any_of(names->begin(), names->end(), [](const std::string& name) {
               return name != FileSet::kDraftFolder && name != kDaemonsLock;
           });
}

Status<AppError> check_replaceable(const RecordingPaths& paths) {
    const auto files = files_of(paths);
    const auto is_there = [](const FilePlace& file) { return file.is_there(); };
    const auto first = std::find_if(files.begin(), files.end(), is_there);
    if (first == files.end() && is_there(paths.file("depth.txt"))) {
        return cannot_create(paths.directory,
                             {.code = ErrorCode::already_exists,
                              .what = "is a data set (depth.txt), which a recording here would hide",
                              .remedy = "give another directory"});
    }
    if (first == files.end()) return Done{};
    const auto meta = read_meta(paths);
    if (meta && meta->is_simulated()) return Done{};
    return cannot_create(
        paths.directory,
        {.code = ErrorCode::already_exists,
         .what = "is not overwritten: expected a simulated recording (meta.yaml with 'source: simulation')",
         .value = "a " + first->filename(),
         .remedy = "give another directory, or remove it yourself"});
}

/// A recording has both files of each camera: a film alone is the user's own, and would be one of the new
/// recording's cameras.
Status<AppError> check_films(const RecordingPaths& paths) {
    for (const std::string& camera : paths.cameras()) {
        if (camera.empty()) continue;
        const FilePlace film = paths.depth(camera);
        const FilePlace epoch = paths.depth_epoch(camera);
        if (film.is_there() && epoch.is_there()) continue;
        const FilePlace& alone = film.is_there() ? film : epoch;
        return cannot_create(paths.directory,
                             {.code = ErrorCode::already_exists,
                              .what = "expected an .oni and an .epoch.yaml of each camera of the recording",
                              .value = fmt::format("{} alone", alone.name().string()),
                              .remedy = "move it away, or give another directory"});
    }
    return Done{};
}

/// The maps that replay wrote into the previous recording's directory.
std::vector<fs::path> maps_of_recording() {
    std::vector<fs::path> maps = {fs::path("maps") / kMapOriginFile};
    for (const char* name : {"depth", "proximity", "fused"}) {
        for (const char* extension : {".ot", ".bt", ".ply"}) {
            maps.push_back(fs::path("maps") / (std::string(name) + extension));
        }
    }
    return maps;
}

/// All names that commit() may write or remove.
std::vector<fs::path> places_of(const RecordingPaths& paths) {
    std::vector<fs::path> places = maps_of_recording();
    places.emplace_back(RecordingPaths::kDepthFolder);
    for (const FilePlace& file : files_of(paths)) places.push_back(file.name());
    return places;
}

/// The lock on a previous recording that may be replaced; empty if there is no recording.
Result<std::optional<FileLock>, AppError> check_former(const OpenFolder& folder, bool may_replace) {
    if (!is_occupied(folder)) return std::optional<FileLock>();
    const RecordingPaths paths(folder);
    if (!may_replace) {
        return cannot_create(
            paths.directory,
            {.code = ErrorCode::already_exists, .what = "is not empty", .remedy = "give another directory"});
    }
    // Checked before any work: an obstacle at the end was there at the beginning.
    if (const auto checked = FileSet::check_places(folder, places_of(paths)); !checked)
        return unexpected(checked.error());
    if (const auto checked = check_replaceable(paths); !checked) return unexpected(checked.error());
    if (const auto checked = check_films(paths); !checked) return unexpected(checked.error());
    auto lock = FileLock::take(paths.meta(), FileLock::Kind::exclusive);
    if (!lock) {
        return cannot_create(paths.directory, {.code = ErrorCode::in_use,
                                               .what = "another octoskin is reading this recording",
                                               .remedy = "wait until it ends, or give another directory"});
    }
    return std::optional(std::move(*lock));
}

}  // namespace

RecordingDraft::RecordingDraft(FileSet files, std::optional<FileLock> former)
    : final_(files.folder()), draft_(files.draft()), files_(std::move(files)), former_(std::move(former)) {}

Status<AppError> RecordingDraft::check(const FilePlace& named, bool may_replace) {
    const EntryKind kind = named.kind();
    if (kind == EntryKind::absent) return Done{};
    auto folder = named.open_folder();
    if (folder) folder = folder->to_write();
    if (!folder) return fail(ExitCode::cannot_create, to_error(folder.error()));
    // First completes what a killed octoskin left partly moved.
    if (folder->kind_of(FileSet::kReadyFolder) != EntryKind::absent) return Done{};
    const auto former = check_former(*folder, may_replace);
    if (!former) return unexpected(former.error());
    return Done{};
}

Result<RecordingDraft, AppError> RecordingDraft::create(const FilePlace& named, bool may_replace) {
    auto files = FileSet::begin(named);
    if (!files) return unexpected(files.error());
    auto former = check_former(files->folder(), may_replace);
    if (!former) return unexpected(former.error());
    return RecordingDraft(std::move(*files), std::move(*former));
}

Status<AppError> RecordingDraft::commit() {
    std::vector<fs::path> files;
    std::vector<fs::path> retired;
    for (const FilePlace& file : files_of(draft_)) (file.is_there() ? files : retired).push_back(file.name());
    // Those of another world, and of other cameras.
    std::vector<FilePlace> former = final_.meshes();
    for (FilePlace& file : files_of_cameras(final_)) former.push_back(std::move(file));
    for (const FilePlace& file : former) {
        const bool is_replaced = std::find(files.begin(), files.end(), file.name()) != files.end();
        const bool is_known = std::find(retired.begin(), retired.end(), file.name()) != retired.end();
        if (!is_replaced && !is_known) retired.push_back(file.name());
    }
    // create() has checked that an existing recording is a simulated one. Without a recording, the maps here
    // may be the user's own.
    const bool replaces_recording = final_.meta().is_there();
    if (replaces_recording) {
        const auto maps = maps_of_recording();
        retired.insert(retired.end(), maps.begin(), maps.end());
    }
    if (const auto committed = files_.commit(files, retired); !committed) return committed;
    // Removes it only if it is empty.
    if (replaces_recording) static_cast<void>(files_.folder().remove_empty("maps"));
    return Done{};
}

Result<FileLock, AppError> lock_recording(const RecordingPaths& recording) {
    auto lock = FileLock::take(recording.meta(), FileLock::Kind::shared);
    if (!lock) {
        return fail(ExitCode::bad_data, {.code = ErrorCode::in_use,
                                         .what = "another octoskin is replacing this recording",
                                         .remedy = "wait until it ends",
                                         .file = recording.directory});
    }
    return std::move(*lock);
}

}  // namespace octoskin
