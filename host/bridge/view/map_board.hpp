// The newest map, for readers that get what changed: frames of the payload of `watch` behind flags and a
// time.
#pragma once

#include <memory>
#include <optional>
#include <set>

#include "common/time.hpp"
#include "host/bridge/view/message_stream.hpp"
#include "host/core/mapping/fused_map.hpp"
#include "host/io/watch/map_changes.hpp"
#include "host/io/watch/watched_map.hpp"

namespace octoskin::view {

class MapBoard final : public StreamSource {
  public:
    /// Bytes of a frame, and at most one brick more.
    static constexpr std::size_t kFrameBytes = std::size_t{256} << 10U;

    /// Another whole map; it shares the bricks. O(bricks written since the one before) if there is a reader.
    void on_map(const watch::WatchedMap& map, WallTime when);
    /// The next map is another one: each reader gets all of it. Until then, the newest map is still shown.
    void begin_again() { is_another_ = true; }

    /// A frame: flags (8 bits: 1 begins, 2 complete), the map's bus time in nanoseconds (64), and the payload
    /// of a frame of `watch` of kind map; little-endian.
    [[nodiscard]] std::unique_ptr<MessageStream> stream() override;

  private:
    class Reader;
    struct Newest {
        FusedMap map;
        HostTime time;
        WallTime when;
        watch::BrickRecords changed;  ///< may be empty
    };
    std::optional<Newest> newest_;
    bool is_another_ = true;
    std::set<Reader*> readers_;
};

}  // namespace octoskin::view
