// Which marks count: those that name about the time at which they came. A mark that comes before the time is
// known waits for it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/time.hpp"
#include "common/wire/messages.hpp"
#include "host/core/pipeline/mark_window.hpp"

namespace octoskin {

class MarkGate {
  public:
    /// A mark is sent at about the time that it names; one further from "now" is damaged or another host's.
    static constexpr Nanoseconds kApartMax{1'000'000'000};

    explicit MarkGate(MapBegin begin) : window_(begin) {}

    enum class Fate : std::uint8_t { taken, ignored, waits };
    /// A mark as it comes. `now`: empty while unknown.
    [[nodiscard]] Fate take(const wire::Mark& mark, std::optional<HostTime> now);

    struct Settled {
        wire::Mark mark;
        bool is_taken = false;
    };
    /// The fates of those that waited, now that the time is known.
    [[nodiscard]] std::vector<Settled> settle(HostTime now);

    /// No further time will come. How many waited, and never will be taken.
    [[nodiscard]] std::size_t give_up();
    [[nodiscard]] std::size_t waiting() const noexcept { return waiting_.size(); }

    /// Whether the map takes what was captured at this instant, as far as is known.
    [[nodiscard]] bool contains(HostTime captured) const { return window_.contains(captured); }

  private:
    MarkWindow window_;
    std::vector<wire::Mark> waiting_;
};

}  // namespace octoskin
