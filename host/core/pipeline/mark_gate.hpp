// Decides which marks count: those whose time is close to their arrival. A mark that arrives before the host
// time is known waits for it.
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
    /// A mark is sent at about the time it contains. One further from the host time is damaged or from
    /// another host.
    static constexpr Nanoseconds kApartMax{1'000'000'000};

    explicit MarkGate(MapBegin begin) : window_(begin) {}

    enum class Fate : std::uint8_t { taken, ignored, waits };
    /// Takes a mark on arrival. `now`: empty while unknown.
    [[nodiscard]] Fate take(const wire::Mark& mark, std::optional<HostTime> now);

    struct Settled {
        wire::Mark mark;
        bool is_taken = false;
    };
    /// Results of the marks that waited, now that the host time is known.
    [[nodiscard]] std::vector<Settled> settle(HostTime now);

    /// No host time will come. Returns the number of waiting marks, which are not taken.
    [[nodiscard]] std::size_t give_up();
    [[nodiscard]] std::size_t waiting() const noexcept { return waiting_.size(); }

    /// True if the map takes measurements captured at this instant, by the marks so far.
    [[nodiscard]] bool contains(HostTime captured) const { return window_.contains(captured); }

  private:
    MarkWindow window_;
    std::vector<wire::Mark> waiting_;
};

}  // namespace octoskin
