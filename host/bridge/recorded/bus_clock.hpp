// The wall time of times on the bus, in a log of the bus.
#pragma once

#include <optional>

#include "common/time.hpp"
#include "common/wire/can_frame.hpp"
#include "host/core/ingest/can_intake.hpp"
#include "host/core/rig/host_rig.hpp"

namespace octoskin::bridge {

/// One offset for a whole log: the clock of SYNC and the wall clock run alike, and messages of one time keep
/// one time. A wall clock that was set later does not change it.
class BusClock {
  public:
    explicit BusClock(Nanoseconds wall_minus_bus) : wall_minus_bus_(wall_minus_bus) {}
    [[nodiscard]] WallTime wall_of(HostTime bus) const noexcept { return {bus.ns + wall_minus_bus_.count()}; }
    [[nodiscard]] HostTime bus_of(WallTime wall) const noexcept {
        return {wall.ns - wall_minus_bus_.count()};
    }

  private:
    Nanoseconds wall_minus_bus_;
};

/// Finds the offset from the frames at the beginning of a log: the first SYNC with its FOLLOW_UP gives it.
class BusClockSearch {
  public:
    explicit BusClockSearch(const HostRig& rig) : intake_(rig) {}
    /// In the order of the log. About 1 us.
    void take(const wire::CanFrame& frame, WallTime stamp) {
        if (clock_) return;
        (void)intake_.on_frame(frame, stamp);
        const auto newest = intake_.host_clock().newest_stamp();
        if (const auto now = intake_.now(); now && newest) clock_.emplace(Nanoseconds{newest->ns - now->ns});
    }
    /// Empty while it is not known.
    [[nodiscard]] const std::optional<BusClock>& clock() const noexcept { return clock_; }

  private:
    CanIntake intake_;
    std::optional<BusClock> clock_;
};

}  // namespace octoskin::bridge
