// When the host's clock leaps: another host sends SYNC, or its clock was set.
#pragma once

#include <cstdint>
#include <optional>

#include "common/time.hpp"
#include "host/core/time/host_clock.hpp"

namespace octoskin {

/// A smaller step back is over by itself: until then everything is older than what was used. After a larger
/// one that would last as long as the step, an hour or for ever. After a step ahead the map would forget what
/// no sensor has confirmed for as long as the step.
class TimeLeap {
  public:
    struct Leap {
        Nanoseconds by{0};              ///< below 0: back
        std::optional<HostTime> begin;  ///< after one ahead: what was captured before is of the time before
    };
    /// It is `now` by `clock`, whose newest stamp is known (asserted). Empty if the time did not leap. O(1).
    [[nodiscard]] std::optional<Leap> notice(HostTime now, const HostClockEstimate& clock);
    /// Another one goes on, whose clock had come to `clock`; this one's has not begun to run.
    void go_on_from(const TimeLeap& ended, const HostClockEstimate& clock);

    [[nodiscard]] std::uint64_t times_back() const noexcept { return times_back_; }
    [[nodiscard]] std::uint64_t times_ahead() const noexcept { return times_ahead_; }

  private:
    /// "Now" at its newest since it last leapt, and what the receive stamps said then.
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
