// Time of the newest of repeated events, and since when they have occurred without a break.
#pragma once

#include <optional>

#include "common/time.hpp"

namespace octoskin {

class Stretch {
  public:
    /// An event occurs. A new stretch begins after more than `break_after` without an event, and with an
    /// event while the host time is unknown (empty) or the first one after that.
    void note(std::optional<HostTime> now, Nanoseconds break_after) noexcept {
        const bool goes_on = now && newest_ && *now - *newest_ <= break_after;
        if (!goes_on) since_ = now;
        newest_ = now;
    }
    /// The newest event of the stretch; empty: none yet, or the host time was unknown then.
    [[nodiscard]] const std::optional<HostTime>& newest() const noexcept { return newest_; }
    /// From the first event of the stretch to its newest.
    [[nodiscard]] Nanoseconds length() const noexcept {
        return newest_ && since_ ? *newest_ - *since_ : Nanoseconds{0};
    }

  private:
    std::optional<HostTime> since_;
    std::optional<HostTime> newest_;
};

}  // namespace octoskin
