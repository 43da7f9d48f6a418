#include "host/apps/daemon/map_saver.hpp"

#include <fmt/format.h>
#include <sys/stat.h>

#include <cassert>
#include <exception>
#include <new>
#include <utility>

#include "host/apps/daemon/clocks.hpp"
#include "host/apps/daemon/map_files.hpp"
#include "host/apps/daemon/quiet_thread.hpp"
#include "host/apps/recording/permission.hpp"
#include "host/apps/recording/shortage.hpp"
#include "host/apps/recording/source_file.hpp"
#include "host/core/mapping/brick_editor.hpp"
#include "host/io/mapfile/map_file.hpp"
#include "host/io/mapfile/octomap_writer.hpp"
#include "host/io/snapshot/snapshot_file.hpp"

namespace octoskin {
namespace {

Result<LoadedMap, AppError> load_to_go_on(const MapConfig& config, const FilePlace& file) {
    const auto refuse = [&file](Error why) {
        if (!why.remedy.empty()) why.remedy += "; ";
        why.remedy += fmt::format("to begin with an empty map, move {} away", kMapFilesText);
        return unexpected(reading_error(file, {ExitCode::bad_data, std::move(why)}));
    };
    auto loaded = load_map_of(config, file);
    if (!loaded) {
        Error why = loaded.error();
        if (why.code == ErrorCode::mismatch) why.remedy = "set map.resolution_m to its former value";
        return refuse(std::move(why));
    }
    if (loaded->has_lost_colours) {
        return refuse({.code = ErrorCode::unsupported,
                       .what = "its voxels have colours, which the next save would lose",
                       .remedy = "to continue with the map without them, run `convert_octree fused.ot "
                                 "fused.bt` and move fused.ot away",
                       .file = file.shown()});
    }
    return std::move(loaded).value();
}

/// Whether the next save of `map` may replace the .bt file beside its .ot file. Files of an earlier octoskin
/// have no comment: such a file may be replaced if it holds the same voxels.
bool is_of_map(const FilePlace& small_file, const FusedMap& map) {
    if (is_saved_by_octoskin(small_file)) return true;
    const auto small = load_map_of(map.config(), small_file);
    return small && encode_bt(small->map) == encode_bt(map);
}

/// Loads the snapshot of the fused.ot beside it; `map_crc32` is that of the fused.ot. The error: why the
/// snapshot cannot be used.
Result<Snapshot, std::string> snapshot_of_map(const FilePlace& file, const MappingConfig& mapping,
                                              std::uint32_t mapping_crc32,
                                              const std::optional<std::uint32_t>& map_crc32) {
    auto snapshot = load_snapshot(file, mapping, mapping_crc32);
    if (!snapshot) return unexpected(snapshot.error().message());
    if (!map_crc32 || snapshot->origin.map_crc32 != map_crc32)
        return unexpected(file.shown().string() + ": was not saved with the fused.ot beside it");
    return std::move(*snapshot);
}

/// `why`: why no snapshot is used; empty: there is none.
Result<KeptMap, AppError> load_alone(const MapConfig& config, const FilePlace& file, const std::string& why) {
    auto loaded = load_to_go_on(config, file);
    if (!loaded) return unexpected(loaded.error());
    KeptMap kept{std::move(loaded->map), std::move(loaded->warnings)};
    if (!why.empty())
        kept.warnings.push_back(why +
                                "; the map continues with the log-odds of fused.ot, and all of it is stale");
    return kept;
}

/// There may be no memory for the message, either.
std::string why_not(const std::optional<NamedFolder>& folder, const std::exception& thrown) {
    try {
        const std::string why = reason_of(thrown);
        return folder ? fmt::format("{}: {}", folder->shown().string(), why) : why;
    } catch (const std::exception&) {
        return "no memory";  // not even enough for a longer message
    }
}

}  // namespace

bool finish_save(const OpenFolder& folder) {
    const FilePlace draft(folder, draft_name_of(kSnapshotFile));
    if (!draft.is_there()) return false;
    const auto map_crc32 = crc32_of(FilePlace(folder, kMapFile));
    const auto is_of_map = [&](const FilePlace& snapshot) {
        const auto origin = origin_of_snapshot_file(snapshot);
        return map_crc32 && origin && origin->map_crc32 == map_crc32;
    };
    if (!is_of_map(draft) || is_of_map(FilePlace(folder, kSnapshotFile))) return false;
    return static_cast<bool>(folder.move(draft.filename(), kSnapshotFile));
}

std::optional<Error> why_no_room(const FusedMap& map, const MapConfig& next) {
    constexpr unsigned kMib = 20;
    const std::uint64_t needed_mib = (bytes_needed(map.layers()) + (std::size_t{1} << kMib) - 1) >> kMib;
    if (needed_mib <= next.memory_max_mib) return std::nullopt;
    return Error{.code = ErrorCode::too_large,
                 .what = fmt::format("expected at least {} MiB, which the map takes", needed_mib),
                 .value = fmt::format("{}", next.memory_max_mib),
                 .remedy = fmt::format("set it to {} or more, or end the daemon and move the saved map away",
                                       needed_mib),
                 .key = "map.memory_max_mib"};
}

MapSaver::MapSaver(NamedFolder folder, Writer writer, Copier copier)
    : copier_(std::move(copier)), work_(std::make_shared<Work>(std::move(folder), std::move(writer))) {
    thread_ = start_without_signals([shared = work_] { work(*shared); });
}

MapSaver::~MapSaver() {
    bool is_busy = false;
    {
        const std::lock_guard lock(work_->mutex);
        work_->is_ending = true;
        is_busy = work_->is_busy;
    }
    work_->changed.notify_all();
    is_busy ? thread_.detach() : thread_.join();
}

Result<std::optional<KeptMap>, AppError> MapSaver::load(const MappingConfig& mapping,
                                                        std::uint32_t mapping_crc32) const {
    if (const auto opened = work_->folder.open()) {
        if (const auto to_write = opened->to_write()) {
            (void)finish_save(*to_write);
            remove_leftovers(*to_write);
        }
    }
    return find(mapping, mapping_crc32);
}

Result<std::optional<KeptMap>, AppError> MapSaver::find(const MappingConfig& mapping,
                                                        std::uint32_t mapping_crc32) const {
    const FilePlace file(work_->folder, kMapFile);
    const FilePlace small_file(work_->folder, kSmallMapFile);
    // A file that cannot be read may exist: starting with an empty map would overwrite it.
    const bool has_file = file.is_there();
    const bool has_small_file = small_file.is_there();
    if (!has_file && !has_small_file) return std::optional<KeptMap>{};
    auto kept = has_file ? load_with(mapping, mapping_crc32) : load_alone(mapping.map, small_file, {});
    if (!kept) return unexpected(kept.error());
    if (has_file && has_small_file && !is_of_map(small_file, kept->map)) {
        return fail(ExitCode::bad_data,
                    {.code = ErrorCode::mismatch,
                     .what = "is another map than fused.ot beside it, octoskin did not save it, and the next "
                             "save would replace it",
                     .remedy = "move it away to continue with fused.ot, or move fused.ot away to continue "
                               "with it",
                     .file = small_file.shown()});
    }
    return std::optional(std::move(*kept));
}

Result<KeptMap, AppError> MapSaver::load_with(const MappingConfig& mapping,
                                              std::uint32_t mapping_crc32) const {
    const FilePlace file(work_->folder, kMapFile);
    const FilePlace snapshot_file(work_->folder, kSnapshotFile);
    if (!snapshot_file.is_there()) return load_alone(mapping.map, file, {});
    auto snapshot = snapshot_of_map(snapshot_file, mapping, mapping_crc32, crc32_of(file));
    if (!snapshot) return load_alone(mapping.map, file, snapshot.error());
    const SnapshotOrigin& origin = snapshot->origin;
    return KeptMap{std::move(snapshot->state.map), {}, true, origin.map_time, origin.placement_crc32};
}

std::uint64_t MapSaver::saved_bytes() const {
    std::uint64_t bytes = 0;
    for (const char* name : kMapFiles) {
        const auto opened = FilePlace(work_->folder, name).open();
        struct stat status {};
        if (opened && ::fstat(opened->descriptor(), &status) == 0)
            bytes += static_cast<std::uint64_t>(status.st_size);
    }
    return bytes;
}

void MapSaver::move_to(NamedFolder folder) {
    const std::lock_guard lock(work_->mutex);
    work_->folder = std::move(folder);
}

bool MapSaver::save(const FusedMap& map, const MakeReady& make_ready) {
    {
        const std::lock_guard lock(work_->mutex);
        work_->record.skipped += work_->is_busy ? 1U : 0U;
        if (std::exchange(work_->is_busy, true)) return false;
        work_->record.saving_since = monotonic_now();
    }
    try {
        FusedMap copy = copier_(map);  // takes long, so the lock is not held
        const SnapshotOrigin origin = make_ready(copy);
        const std::lock_guard lock(work_->mutex);
        work_->waiting.emplace(Save{std::move(copy), origin});
    } catch (const std::bad_alloc&) {
        constexpr unsigned kMib = 20;
        end_save(*work_, fmt::format("no memory for a copy of its {} MiB: lower map.memory_max_mib, or give "
                                     "the service more",
                                     map.memory_bytes() >> kMib));
        return false;
    }
    work_->changed.notify_all();
    return true;
}

void MapSaver::save_last(FusedMap map, const SnapshotOrigin& origin) {
    {
        const std::lock_guard lock(work_->mutex);
        assert(!work_->is_busy);
        work_->is_busy = true;
        work_->record.saving_since = monotonic_now();
        work_->waiting.emplace(Save{std::move(map), origin});
    }
    work_->changed.notify_all();
}

bool MapSaver::finish(Nanoseconds patience) {
    std::unique_lock lock(work_->mutex);
    return work_->changed.wait_for(lock, patience, [this] { return !work_->is_busy; });
}

SaveRecord MapSaver::record() const {
    const std::lock_guard lock(work_->mutex);
    return work_->record;
}

void MapSaver::work(Work& shared) {
    std::unique_lock lock(shared.mutex);
    while (true) {  // until the destructor ends it
        shared.changed.wait(lock, [&shared] { return shared.waiting || shared.is_ending; });
        if (shared.is_ending) return;
        std::optional<Save> save = std::exchange(shared.waiting, std::nullopt);
        std::optional<NamedFolder> folder;
        std::string error;
        try {
            folder = shared.folder;
            lock.unlock();
            error = shared.writer(save->map, save->origin, *folder);
        } catch (const std::exception& thrown) {  // no memory for the text of the file
            error = why_not(folder, thrown);
        }
        if (lock.owns_lock()) lock.unlock();
        save.reset();
        end_save(shared, std::move(error));
        lock.lock();
    }
}

void MapSaver::end_save(Work& shared, std::string error) {
    {
        const std::lock_guard lock(shared.mutex);
        shared.is_busy = false;
        shared.record.saving_since.reset();
        ++(error.empty() ? shared.record.saved : shared.record.failed);
        if (error.empty()) shared.record.newest = monotonic_now();
        shared.record.error = std::move(error);
    }
    shared.changed.notify_all();
}

std::string MapSaver::write_map(const FusedMap& map, const SnapshotOrigin& origin,
                                const NamedFolder& folder) {
    auto exact = draft_map(map, {folder, kMapFile});
    if (!exact) return exact.error().message();
    auto small = draft_map(map, {folder, kSmallMapFile});
    if (!small) return small.error().message();
    SnapshotOrigin of_map = origin;
    of_map.map_crc32 = exact->crc();
    auto snapshot = draft_snapshot({map.copy(), {}}, of_map, {folder, kSnapshotFile});
    if (!snapshot) return snapshot.error().message();
    // If the process is killed after the first rename, the complete draft of the snapshot remains, and the
    // next start uses it.
    FileDraft drafts[] = {std::move(*exact), std::move(*snapshot), std::move(*small)};
    const auto put = put_in_place(drafts);
    return put ? std::string() : put.error().message();
}

}  // namespace octoskin
