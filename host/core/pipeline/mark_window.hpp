// The times in which the map takes measurements: between START and STOP, or always.
#pragma once

#include <optional>
#include <vector>

#include "common/time.hpp"
#include "common/wire/messages.hpp"

namespace octoskin {

enum class MapBegin : std::uint8_t {
    first_usable,  ///< from the first usable measurement; marks are ignored
    start_mark,    ///< from START until STOP, and again; for a recording that contains a START
};

class MarkWindow {
  public:
    explicit MarkWindow(MapBegin begin) : begin_(begin) {}

    [[nodiscard]] static HostTime time_of(const wire::Mark& mark) {
        return {static_cast<std::int64_t>(mark.host_time_us) * 1000};
    }

    /// False if the mark changes nothing: marks are ignored, a START while a window is open, a STOP while
    /// none is, or a time that goes back.
    [[nodiscard]] bool take(const wire::Mark& mark);

    /// True if the map takes measurements captured at this instant, by the marks so far. O(stored windows),
    /// at most 16; older windows are dropped.
    [[nodiscard]] bool contains(HostTime captured) const;

  private:
    struct Window {
        HostTime start;
        std::optional<HostTime> stop;
    };
    MapBegin begin_;
    std::vector<Window> windows_;
};

}  // namespace octoskin
