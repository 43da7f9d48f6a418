#include "host/core/pipeline/time_jump.hpp"

#include <algorithm>
#include <cassert>

namespace octoskin {
namespace {

/// More than the correction after a single time stamp that ran ahead (HostClockConfig::ahead_tolerance). Less
/// than the 200 ms that a node's clock takes to settle again (ClockMapConfig::settling), so that no reading
/// uses a pose from before the jump, which belongs to another instant.
constexpr Nanoseconds kTimeBackMax{150'000'000};
/// Smaller jumps age nothing by a second.
constexpr Nanoseconds kTimeAheadMax{1'000'000'000};

}  // namespace

std::optional<TimeJump::Jump> TimeJump::notice(HostTime now, const HostClockEstimate& clock) {
    assert(clock.newest_stamp());
    const TimeSample sample{now, *clock.newest_stamp(), clock.running()};
    std::optional<Jump> jump;
    if (newest_) {
        const Nanoseconds went = now - newest_->now;
        const Nanoseconds by = went - passed_between(*newest_, sample);
        const bool is_back = went < -kTimeBackMax;
        if (is_back || by > kTimeAheadMax) {
            ++(is_back ? times_back_ : times_ahead_);
            newest_.reset();
            // Inputs with times from before would age the map by the jump.
            jump = Jump{by, is_back ? std::nullopt : std::optional(now - kTimeAheadMax)};
        }
    }
    if (!newest_ || now > newest_->now) newest_ = sample;
    return jump;
}

void TimeJump::resume_from(const TimeJump& ended, const HostClockEstimate& clock) {
    newest_ = ended.newest_;
    if (newest_) newest_->running -= clock.running();
}

/// Consecutively received frames give a lower bound of the time that passed. Across a silence, only the time
/// stamps or the host time do, whichever clock was not set. The smaller of the two is used, because too much
/// would expire a map. If the host time went back, as after a controller was switched off for some time, only
/// the time stamps count.
Nanoseconds TimeJump::passed_between(const TimeSample& before, const TimeSample& now) {
    const Nanoseconds by_stamps{now.stamp.ns - before.stamp.ns};
    const Nanoseconds went = now.now - before.now;
    const Nanoseconds passed = went < Nanoseconds{0} ? by_stamps : std::min(by_stamps, went);
    return std::max(now.running - before.running, passed);
}

}  // namespace octoskin
