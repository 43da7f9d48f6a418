// When a SIGHUP is obeyed: at once, or later if one came a moment ago. However many come, mapping continues,
// and the files are read once more after the last.
#pragma once

#include <algorithm>
#include <optional>
#include <utility>

#include "common/time.hpp"

namespace octoskin {

class ReloadPace {
  public:
    /// Delay of the next one after one that was refused, or found no change.
    static constexpr Nanoseconds kAfterNothing{1'000'000'000};
    /// Delay after one that changed something: readings are used again after 1.5 s, and problems are judged
    /// again after 3 s.
    static constexpr Nanoseconds kAfterChange{4'000'000'000};

    /// Notes a SIGHUP. True if it is the first that waits; one that comes while files are read waits, too.
    bool ask() noexcept { return !std::exchange(is_asked_, true); }
    /// A SIGHUP is to be obeyed now.
    [[nodiscard]] bool is_due(HostTime now) const noexcept {
        return is_asked_ && !is_reading_ && wait(now).count() == 0;
    }
    /// How long a SIGHUP that comes now waits.
    [[nodiscard]] Nanoseconds wait(HostTime now) const noexcept {
        return next_ ? std::max(*next_ - now, Nanoseconds{0}) : Nanoseconds{0};
    }
    /// The files are read now, for all SIGHUPs so far.
    void begin_reading() noexcept {
        is_asked_ = false;
        is_reading_ = true;
    }
    /// All that came before `begin_reading` are obeyed. `has_changed`: the settings changed.
    void obeyed(HostTime now, bool has_changed) noexcept {
        is_reading_ = false;
        next_ = now + (has_changed ? kAfterChange : kAfterNothing);
    }

  private:
    bool is_asked_ = false;
    bool is_reading_ = false;
    std::optional<HostTime> next_;
};

}  // namespace octoskin
