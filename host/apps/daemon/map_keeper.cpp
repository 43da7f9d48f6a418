#include "host/apps/daemon/map_keeper.hpp"

#include <utility>

#include "host/apps/daemon/clocks.hpp"
#include "host/apps/daemon/quiet_thread.hpp"
#include "host/io/mapfile/atomic_file.hpp"
#include "host/io/mapfile/map_file.hpp"

namespace octoskin {
namespace {

constexpr const char* kMapFile = "fused.ot";
constexpr const char* kSmallMapFile = "fused.bt";

}  // namespace

MapKeeper::MapKeeper(std::filesystem::path folder, Writer writer) : work_(std::make_shared<Work>()) {
    work_->folder = std::move(folder);
    work_->writer = std::move(writer);
    remove_leftovers(work_->folder);
    thread_ = start_without_signals([shared = work_] { work(*shared); });
}

MapKeeper::~MapKeeper() {
    bool is_busy = false;
    {
        const std::lock_guard lock(work_->mutex);
        work_->is_ending = true;
        is_busy = work_->is_busy;
    }
    work_->changed.notify_all();
    is_busy ? thread_.detach() : thread_.join();
}

Result<std::optional<FusedMap>, AppError> MapKeeper::load(const MapConfig& config) const {
    const auto file = work_->folder / kMapFile;
    std::error_code error;
    const bool is_there = std::filesystem::exists(file, error);
    // What cannot be seen may be there: beginning anew would overwrite it.
    if (error) return fail(ExitCode::no_input, file.string() + ": " + error.message());
    if (!is_there) return std::optional<FusedMap>{};
    auto map = load_map(file, {.map = config});
    if (!map) return fail(ExitCode::bad_data, map.error().message);
    if (map->resolution_m() != config.resolution_m) {
        return fail(ExitCode::bad_data, file.string() + ": its voxels are " +
                                            std::to_string(map->resolution_m()) + " m, the mapping's are " +
                                            std::to_string(config.resolution_m) + " m");
    }
    return std::optional(std::move(map).value());
}

bool MapKeeper::save(const FusedMap& map) {
    {
        const std::lock_guard lock(work_->mutex);
        work_->record.skipped += work_->is_busy ? 1U : 0U;
        if (std::exchange(work_->is_busy, true)) return false;
    }
    FusedMap copy = map.copy();  // takes long, so nobody is kept waiting for the lock
    {
        const std::lock_guard lock(work_->mutex);
        work_->waiting.emplace(std::move(copy));
    }
    work_->changed.notify_all();
    return true;
}

bool MapKeeper::finish(Nanoseconds patience) {
    std::unique_lock lock(work_->mutex);
    return work_->changed.wait_for(lock, patience, [this] { return !work_->is_busy; });
}

SaveRecord MapKeeper::record() const {
    const std::lock_guard lock(work_->mutex);
    return work_->record;
}

void MapKeeper::work(Work& shared) {
    std::unique_lock lock(shared.mutex);
    while (true) {  // until the destructor says so
        shared.changed.wait(lock, [&shared] { return shared.waiting || shared.is_ending; });
        if (shared.is_ending) return;
        std::optional<FusedMap> map = std::exchange(shared.waiting, std::nullopt);
        lock.unlock();
        std::string error = shared.writer(*map, shared.folder);
        map.reset();
        lock.lock();
        shared.is_busy = false;
        ++(error.empty() ? shared.record.saved : shared.record.failed);
        if (error.empty()) shared.record.newest = monotonic_now();
        shared.record.error = std::move(error);
        shared.changed.notify_all();
    }
}

std::string MapKeeper::write_map(const FusedMap& map, const std::filesystem::path& folder) {
    for (const char* file : {kMapFile, kSmallMapFile}) {
        if (const auto saved = save_map(map, folder / file); !saved) return saved.error().message;
    }
    return {};
}

}  // namespace octoskin
