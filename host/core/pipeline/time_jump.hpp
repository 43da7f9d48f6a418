// Detects time jumps of the host's clock: another host sends SYNC, or its clock was set.
#pragma once

#include <cstdint>
#include <optional>

#include "common/time.hpp"
#include "host/core/time/host_clock.hpp"

namespace octoskin {

/// After a step back, all inputs are older than those already used, until the time has caught up. That is
/// acceptable for 0.15 s, but it lasts as long as the step, which may be an hour or years. After a step
/// ahead, the map would age by the step, and voxels would expire that were seen just before it.
class TimeJump {
  public:
    struct Jump {
        Nanoseconds by{0};              ///< below 0: back
        std::optional<HostTime> begin;  ///< after a jump ahead: earlier captures are from before the jump
    };
    /// Call with the host time of `clock`, whose newest time stamp is known (asserted). Empty if there was no
    /// jump. O(1).
    [[nodiscard]] std::optional<Jump> notice(HostTime now, const HostClockEstimate& clock);
    /// Continues another object, whose clock has reached `clock`. This object's clock has not begun to run.
    void resume_from(const TimeJump& ended, const HostClockEstimate& clock);

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
