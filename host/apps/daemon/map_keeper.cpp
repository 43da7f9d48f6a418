#include "host/apps/daemon/map_keeper.hpp"

#include <utility>

#include "host/apps/daemon/event_loop.hpp"
#include "host/apps/daemon/quiet_thread.hpp"
#include "host/io/mapfile/atomic_file.hpp"
#include "host/io/mapfile/map_file.hpp"

namespace octoskin {
namespace {

constexpr const char* kMapFile = "fused.ot";
constexpr const char* kSmallMapFile = "fused.bt";

}  // namespace

MapKeeper::MapKeeper(std::filesystem::path folder) : folder_(std::move(folder)) {
    std::error_code ignored;  // what is wrong with the folder the first save tells
    std::filesystem::create_directories(folder_, ignored);
    remove_leftovers(folder_);
    thread_ = start_without_signals([this] { work(); });
}

MapKeeper::~MapKeeper() {
    {
        const std::lock_guard lock(mutex_);
        is_ending_ = true;
    }
    changed_.notify_all();
    thread_.join();
}

Result<std::optional<FusedMap>, AppError> MapKeeper::load(const MapConfig& config) const {
    const auto file = folder_ / kMapFile;
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

void MapKeeper::save(FusedMap copy) {
    {
        const std::lock_guard lock(mutex_);
        record_.displaced += waiting_ ? 1U : 0U;
        waiting_ = std::move(copy);
    }
    changed_.notify_all();
}

bool MapKeeper::finish(Nanoseconds patience) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, patience, [this] { return !waiting_ && !is_busy_; });
}

SaveRecord MapKeeper::record() const {
    const std::lock_guard lock(mutex_);
    return record_;
}

void MapKeeper::work() {
    std::unique_lock lock(mutex_);
    while (true) {  // until the destructor says so
        changed_.wait(lock, [this] { return waiting_ || is_ending_; });
        if (is_ending_) return;
        const FusedMap map = std::move(*std::exchange(waiting_, std::nullopt));
        is_busy_ = true;
        lock.unlock();
        std::string error = write(map);
        lock.lock();
        is_busy_ = false;
        ++(error.empty() ? record_.saved : record_.failed);
        if (error.empty()) record_.newest = monotonic_now();
        record_.error = std::move(error);
        changed_.notify_all();
    }
}

std::string MapKeeper::write(const FusedMap& map) const {
    for (const char* file : {kMapFile, kSmallMapFile}) {
        if (const auto saved = save_map(map, folder_ / file); !saved) return saved.error().message;
    }
    return {};
}

}  // namespace octoskin
