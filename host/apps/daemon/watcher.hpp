// The output of one client of `watch`: what it lacks, in bounded memory, however slowly it reads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/time.hpp"
#include "host/core/mapping/fused_map.hpp"
#include "host/io/watch/map_changes.hpp"
#include "host/io/watch/watch_frame.hpp"

namespace octoskin {

/// A copy of the daemon's map and its time on the bus.
struct MapNow {
    FusedMap map;
    HostTime time{0};
    watch::BrickRecords changed = {};  ///< bricks of it that the map before had in another way; may be empty
};

/// What goes to all watchers alike.
struct WatchEvent {
    watch::FrameKind kind = watch::FrameKind::range;
    HostTime time{0};
    std::shared_ptr<const std::string> payload;
};

struct WatchWants {
    bool map = false;
    bool ranges = false;
    bool joints = false;
    bool status = false;
    bool images = false;
    bool robot = false;
    [[nodiscard]] bool has(watch::FrameKind kind) const noexcept;
};

class Watcher {
  public:
    /// Events that wait; beyond this the oldest is dropped and counted, but for the newest of a lasting kind.
    static constexpr std::size_t kEventsMax = 1024;
    /// Bytes that are made at once.
    static constexpr std::size_t kChunkBytes = std::size_t{64} << 10U;

    /// `greeting`: bytes before the first frame.
    explicit Watcher(const WatchWants& wants, std::string greeting)
        : wants_(wants), bytes_(std::move(greeting)) {}

    /// Another map is there; `changed`: against the one before. The first time, all of its bricks are
    /// missing.
    void on_map(const MapNow& now, const watch::BrickCodes& changed);
    /// Does nothing if the watcher does not want the kind; each wants a reload. The map that waits is of the
    /// rig before the reload and does not go out any more; one that is given later follows the reload.
    void on_event(const WatchEvent& event);

    /// The next bytes to send; empty: there are none. `now`: the newest map, null if there is none yet.
    /// Throws std::bad_alloc.
    [[nodiscard]] std::string_view pending(const MapNow* now);
    /// So many of these are sent.
    void on_sent(std::size_t bytes);
    [[nodiscard]] const WatchWants& wants() const noexcept { return wants_; }

  private:
    void drop_oldest();
    void put_events();
    void put(const WatchEvent& event);
    void put(watch::FrameKind kind, std::uint8_t flags, HostTime time, std::string_view payload);

    WatchWants wants_;
    std::string bytes_;
    std::size_t sent_ = 0;
    std::uint64_t number_ = 0;
    std::uint64_t lost_ = 0;
    std::deque<WatchEvent> events_;
    std::vector<WatchEvent> overdue_;  ///< older than all of events_; of lasting kinds, one of each
    std::size_t reloads_waiting_ = 0;  ///< in events_ and overdue_
    watch::MapReader map_;
};

}  // namespace octoskin
