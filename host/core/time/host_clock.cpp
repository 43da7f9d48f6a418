#include "host/core/time/host_clock.hpp"

#include <algorithm>
#include <chrono>

namespace octoskin {
namespace {

/// A FOLLOW_UP completes its SYNC before the next one, a second later, replaces it.
constexpr Nanoseconds kExchangeMax{2'000'000'000};

/// Differences of such stamps, and host times of 48 bits of microseconds on top, stay within 63 bits.
WallTime bounded(WallTime stamp) {
    return {std::clamp(stamp.ns, std::int64_t{0}, std::int64_t{1} << 62)};
}

}  // namespace

bool HostClockEstimate::follows(WallTime before, WallTime stamp) const {
    return stamp.ns >= before.ns - config_.back_tolerance.count() &&
           stamp.ns <= before.ns + config_.ahead_tolerance.count();
}

void HostClockEstimate::observe(WallTime received) {
    const WallTime stamp = bounded(received);
    if (!stamp_max_ || follows(*stamp_max_, stamp)) {
        stamp_max_ = stamp_max_ ? std::max(*stamp_max_, stamp) : stamp;
        stamps_ignored_ += jump_ ? jump_->stamps : 0U;
        jump_.reset();
        return;
    }
    if (jump_ && follows(jump_->newest, stamp)) {
        jump_ = {std::max(jump_->newest, stamp), jump_->stamps + 1};
    } else {
        stamps_ignored_ += jump_ ? jump_->stamps : 0U;
        jump_ = {stamp, 1};
    }
    if (jump_->stamps < config_.jump_agreement) {
        return;
    }
    ++(jump_->newest < *stamp_max_ ? steps_back_ : steps_ahead_);
    is_in_doubt_ = true;
    stamp_max_ = jump_->newest;
    jump_.reset();
}

bool HostClockEstimate::is_discredited(WallTime sync_stamp) const {
    // While a jump is undecided the SYNC may be the first to tell the new time.
    return stamp_max_ && !jump_ &&
           (sync_stamp > *stamp_max_ || stamp_max_->ns - sync_stamp.ns > kExchangeMax.count());
}

void HostClockEstimate::learn(const SyncStamp& sync) {
    const WallTime stamp = bounded(sync.stamp);
    if (is_discredited(stamp)) {
        return;
    }
    const Nanoseconds offset{sync.host.ns - stamp.ns};
    const bool is_first = !offset_;
    const bool is_step_confirmed = offset_next_ && agree(*offset_next_, offset);
    if (!is_first && !is_step_confirmed && !agree(*offset_, offset)) {
        is_in_doubt_ = true;
        offset_next_ = offset;
        return;
    }
    relocks_ += is_step_confirmed ? 1U : 0U;
    is_in_doubt_ = false;
    offset_ = offset;
    offset_next_.reset();
}

std::optional<HostTime> HostClockEstimate::now() const {
    if (!offset_ || !stamp_max_ || jump_ || is_in_doubt_) {
        return std::nullopt;
    }
    return HostTime{stamp_max_->ns + offset_->count()};
}

bool HostClockEstimate::agree(Nanoseconds a, Nanoseconds b) const {
    return std::chrono::abs(a - b) <= config_.step_tolerance;
}

}  // namespace octoskin
