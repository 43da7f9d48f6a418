// Detects time jumps of the host's clock: another host sends SYNC, or its clock was set.
#pragma once

#include <cstdint>
#include <optional>

#include "common/time.hpp"
#include "host/core/time/host_clock.hpp"

namespace octoskin {

/// A smaller step back resolves itself: until then, all inputs are older than those used. After a larger step
/// back, this would last as long as the step, an hour or for ever. After a step ahead, the map would expire
/// everything that no sensor has confirmed for as long as the step.
class TimeLeap {
  public:
    struct Leap {
        Nanoseconds by{0};              ///< below 0: back
        std::optional<HostTime> begin;  ///< after a jump ahead: earlier captures are from before it
    };
    /// Call with the host time of `clock`, whose newest time stamp is known (asserted). Empty if there was no
    /// jump. O(1).
    [[nodiscard]] std::optional<Leap> notice(HostTime now, const HostClockEstimate& clock);
    /// Continues another object, whose clock has reached `clock`. This object's clock has not begun to run.
    void go_on_from(const TimeLeap& ended, const HostClockEstimate& clock);

    [[nodiscard]] std::uint64_t times_back() const noexcept { return times_back_; }
    [[nodiscard]] std::uint64_t times_ahead() const noexcept { return times_ahead_; }

  private:
    /// The latest host time since the last jump, with the receive time stamp and running time at that moment.
    struct TimeSample {
        HostTime now;
        WallTime stamp;
        Nanoseconds running{0};
    };
    [[nodiscard]] static Nanoseconds passed_between(const TimeSample& before, const TimeSample& now);

    std::optional<TimeSample> newest_;
    std::uint64_t times_back_ = 0;
    std::uint64_t times_ahead_ = 0;
};

}  // namespace octoskin
