// Saves maps while others go on: a thread of its own, one save at a time, the newest asked for wins.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "common/result.hpp"
#include "common/time.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/core/mapping/fused_map.hpp"

namespace octoskin {

struct SaveRecord {
    std::uint64_t saved = 0;
    std::uint64_t failed = 0;
    std::uint64_t displaced = 0;  ///< asked for while one waited, and never written
    std::optional<HostTime> newest;
    std::string error;  ///< of the newest save; empty if it went well
};

class MapKeeper {
  public:
    /// `folder` gets fused.ot and fused.bt. What a dead process left of a save there is removed.
    explicit MapKeeper(std::filesystem::path folder);
    /// Ends the thread; a save that waits is dropped: `finish` first.
    ~MapKeeper();
    MapKeeper(const MapKeeper&) = delete;
    MapKeeper& operator=(const MapKeeper&) = delete;

    /// The map that was saved last, checked as every foreign map; empty if there is none. An error names the
    /// file and what is wrong with it.
    [[nodiscard]] Result<std::optional<FusedMap>, AppError> load(const MapConfig& config) const;

    /// Hands over a copy. Never waits for the disk.
    void save(FusedMap copy);
    /// Waits until nothing is left to save, `patience` at most; false if that was too short.
    [[nodiscard]] bool finish(Nanoseconds patience);

    [[nodiscard]] SaveRecord record() const;

  private:
    void work();
    [[nodiscard]] std::string write(const FusedMap& map) const;

    std::filesystem::path folder_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::optional<FusedMap> waiting_;
    bool is_busy_ = false;
    bool is_ending_ = false;
    SaveRecord record_;
    std::thread thread_;
};

}  // namespace octoskin
