// When the map takes measurements: between START and STOP, or always.
#pragma once

#include <optional>
#include <vector>

#include "common/time.hpp"
#include "common/wire/messages.hpp"

namespace octoskin {

enum class MapBegin : std::uint8_t {
    first_usable,  ///< at the first measurement that can be used; marks are ignored
    start_mark,    ///< at START, until STOP, and again; for a recording that has a START in it
};

class MarkWindow {
  public:
    explicit MarkWindow(MapBegin begin) : begin_(begin) {}

    [[nodiscard]] static HostTime time_of(const wire::Mark& mark) {
        return {static_cast<std::int64_t>(mark.host_time_us) * 1000};
    }

    /// False if the mark changes nothing: marks are ignored, START while it is open, STOP while it is shut,
    /// or a time that goes back.
    [[nodiscard]] bool take(const wire::Mark& mark);

    /// Whether the map takes what was captured at this instant, as far as is known. O(marks kept), 16 at
    /// most: old windows are forgotten.
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
