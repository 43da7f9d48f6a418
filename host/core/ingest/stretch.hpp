// What comes again and again: when it came last, and since when without a break.
#pragma once

#include <optional>

#include "common/time.hpp"

namespace octoskin {

class Stretch {
  public:
    /// It comes. After more than `break_after` without it, that is a new stretch; so is what comes while
    /// "now" is unknown (empty), and after.
    void note(std::optional<HostTime> now, Nanoseconds break_after) noexcept {
        const bool goes_on = now && newest_ && *now - *newest_ <= break_after;
        if (!goes_on) since_ = now;
        newest_ = now;
    }
    /// The newest of the stretch; empty: none yet, or "now" was unknown then.
    [[nodiscard]] const std::optional<HostTime>& newest() const noexcept { return newest_; }
    /// From the first of the stretch to its newest.
    [[nodiscard]] Nanoseconds length() const noexcept {
        return newest_ && since_ ? *newest_ - *since_ : Nanoseconds{0};
    }

  private:
    std::optional<HostTime> since_;
    std::optional<HostTime> newest_;
};

}  // namespace octoskin
