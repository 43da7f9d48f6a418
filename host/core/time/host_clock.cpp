#include "host/core/time/host_clock.hpp"

#include <algorithm>
#include <chrono>

namespace octoskin {
namespace {

/// A FOLLOW_UP completes its SYNC before the next SYNC replaces it, a second later.
constexpr Nanoseconds kExchangeMax{2'000'000'000};

/// Bounds a time stamp, so that differences of time stamps, with host times of 48 bits of microseconds added,
/// stay within 63 bits.
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
        accept(stamp);
        return;
    }
    if (jump_ && follows(jump_->newest, stamp)) {
        jump_ = {jump_->first, std::max(jump_->newest, stamp), jump_->stamps + 1};
    } else {
        stamps_ignored_ += jump_ ? jump_->stamps : 0U;
        jump_ = {stamp, stamp, 1};
    }
    if (jump_->stamps >= config_.jump_agreement) {
        settle_jump();
    }
}

void HostClockEstimate::accept(WallTime stamp) {
    stamps_ignored_ += jump_ ? jump_->stamps : 0U;
    jump_.reset();
    if (stamp_max_ && stamp <= *stamp_max_) {
        return;
    }
    if (stamp_max_) running_ += Nanoseconds{stamp.ns - stamp_max_->ns};
    stamp_before_ = stamp_max_;
    stamp_max_ = stamp;
}

void HostClockEstimate::settle_jump() {
    const bool is_back = jump_->newest < *stamp_max_;
    // A step back by less than the last gap between two time stamps looks the same. It is below
    // ahead_tolerance, so no range gets a wrong turn of its time field, and the next exchange detects the
    // step.
    const bool had_run_ahead = is_back && stamp_before_ && follows(*stamp_before_, jump_->first);
    if (had_run_ahead) {
        ++stamps_ignored_;
    } else {
        ++(is_back ? steps_back_ : steps_ahead_);
        is_in_doubt_ = true;
    }
    running_ += Nanoseconds{jump_->newest.ns - (had_run_ahead ? *stamp_max_ : jump_->first).ns};
    stamp_before_.reset();
    stamp_max_ = jump_->newest;
    jump_.reset();
}

bool HostClockEstimate::is_discredited(WallTime sync_stamp) const {
    if (!stamp_max_) {
        return false;
    }
    if (jump_) {
        // The SYNC may be the first frame with the new time, or the frame whose time stamp ran ahead of all
        // others.
        return jump_->newest < *stamp_max_ && sync_stamp == *stamp_max_;
    }
    return sync_stamp > *stamp_max_ || stamp_max_->ns - sync_stamp.ns > kExchangeMax.count();
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

std::optional<HostClockFault> HostClockEstimate::fault() const noexcept {
    if (!offset_ || !stamp_max_) return HostClockFault::no_exchange;
    if (offset_next_) return HostClockFault::exchanges_disagree;
    if (jump_ || is_in_doubt_) return HostClockFault::stamps_jumped;
    return std::nullopt;
}

std::optional<HostTime> HostClockEstimate::now() const {
    if (fault()) {
        return std::nullopt;
    }
    return HostTime{stamp_max_->ns + offset_->count()};
}

bool HostClockEstimate::agree(Nanoseconds a, Nanoseconds b) const {
    return std::chrono::abs(a - b) <= config_.step_tolerance;
}

}  // namespace octoskin
