#include "host/core/pipeline/time_leap.hpp"

#include <algorithm>
#include <cassert>

namespace octoskin {
namespace {

/// More than one stamp that ran ahead takes back (HostClockConfig::ahead_tolerance). Less than the 200 ms
/// that a node's clock takes to settle anew (ClockMapConfig::settling): so that no reading finds a pose of
/// the time before, which was another instant.
constexpr Nanoseconds kTimeBackMax{150'000'000};
/// Less ages nothing by a second.
constexpr Nanoseconds kTimeAheadMax{1'000'000'000};

}  // namespace

std::optional<TimeLeap::Leap> TimeLeap::notice(HostTime now, const HostClockEstimate& clock) {
    assert(clock.newest_stamp());
    const TimeSample sample{now, *clock.newest_stamp(), clock.running()};
    std::optional<Leap> leapt;
    if (newest_) {
        const Nanoseconds went = now - newest_->now;
        const Nanoseconds by = went - passed_between(*newest_, sample);
        const bool is_back = went < -kTimeBackMax;
        if (is_back || by > kTimeAheadMax) {
            ++(is_back ? times_back_ : times_ahead_);
            newest_.reset();
            // What still has the time before would make the map older by the leap.
            leapt = Leap{by, is_back ? std::nullopt : std::optional(now - kTimeAheadMax)};
        }
    }
    if (!newest_ || now > newest_->now) newest_ = sample;
    return leapt;
}

void TimeLeap::go_on_from(const TimeLeap& ended, const HostClockEstimate& clock) {
    newest_ = ended.newest_;
    if (newest_) newest_->running -= clock.running();
}

/// Frames that were received one after the other tell how much passed at least. Over a silence only stamps
/// do, or "now": whichever of the two clocks was not set. The lesser is taken: too much forgets a map. Where
/// "now" went back, as after a controller was off for a while, the stamps alone tell.
Nanoseconds TimeLeap::passed_between(const TimeSample& before, const TimeSample& now) {
    const Nanoseconds by_stamps{now.stamp.ns - before.stamp.ns};
    const Nanoseconds went = now.now - before.now;
    const Nanoseconds passed = went < Nanoseconds{0} ? by_stamps : std::min(by_stamps, went);
    return std::max(now.running - before.running, passed);
}

}  // namespace octoskin
