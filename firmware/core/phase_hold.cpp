#include "firmware/core/phase_hold.hpp"

#include <algorithm>
#include <chrono>
#include <cstdlib>

namespace octoskin::node {

namespace {

// Oscillators are 6-7 % off. A period that is longer by more than this skips its slots: that is PeriodTrim's.
constexpr std::int64_t kWalkMaxPermille = 150;
// Who hardly walks is started near its phase: which way it will go is not known then.
constexpr std::int64_t kPeriodsAhead = 32;
// A first range's time is known to a tenth of a millisecond or two: the mean of many is known better.
constexpr std::int64_t kFirstsAveraged = 16;

// A part's first run, before it is trimmed, and those after its first trims tell nothing about its
// oscillator.
constexpr int kStartsForFree = 4;
// 1,024 periods: a tenth of a percent of the readings.
constexpr int kDoublingsMax = 6;

}  // namespace

void PhaseHold::restart(NodeTime started, Microseconds off, Microseconds period, bool is_trimmed) noexcept {
    if (period != period_) {
        firsts_ = 0;
        starts_in_vain_ = 0;
    }
    started_ = started;
    off_at_start_ = off;
    off_ = off;
    period_ = period;
    is_trimmed_ = is_trimmed;
    periods_ = 0;
    last_.reset();
    is_judged_ = false;
}

void PhaseHold::observe(const TimeBracket& ready) noexcept {
    if (ready.width() > policy_.phase_known_within) return;
    const NodeTime at = ready.middle();
    if (last_) {
        const Microseconds since = elapsed(*last_, at);
        const Microseconds strayed = nearest_to_zero(since);
        periods_ += (since - strayed) / period_;
        off_ += strayed;
    } else {
        begin(elapsed(started_, at));
    }
    last_ = at;
    if (!is_judged_ && periods_ >= policy_.phase_periods_min) judge_start();
}

/// How long after its start a run's first range was ready says where the others should be. That is the part's
/// own, and the same each time, once its period is.
void PhaseHold::begin(Microseconds first_after) noexcept {
    if (!is_trimmed_) return;
    firsts_ = std::min(firsts_ + 1, kFirstsAveraged);
    if (firsts_ == 1) first_after_ = first_after;
    // It may be a later range, if the first could not be read.
    const Microseconds more = nearest_to_zero(first_after - first_after_);
    first_after_ += more / firsts_;
    off_ += more - more / firsts_;
}

/// The same place within a period.
Microseconds PhaseHold::nearest_to_zero(Microseconds off) const noexcept {
    const Microseconds half = off.count() < 0 ? -period_ / 2 : period_ / 2;
    return off - (off + half) / period_ * period_;
}

/// Who walks by half a step of its register has not walked through all that is allowed after so few periods.
/// (It may be out of its phase all the same, if it was started late.)
void PhaseHold::judge_start() noexcept {
    is_judged_ = true;
    const Microseconds walked = off_ - off_at_start_;
    const bool is_in_vain =
        std::abs(walked.count()) > (policy_.phase_tolerance + policy_.phase_start_off).count();
    // One that wanders has not come far now and then by chance.
    starts_in_vain_ = is_in_vain ? std::min(starts_in_vain_ + 1, kStartsForFree + kDoublingsMax)
                                 : std::max(starts_in_vain_ - 1, 0);
}

bool PhaseHold::is_out() const noexcept {
    return std::abs(off_.count()) > policy_.phase_tolerance.count();
}

/// So many periods are between two starts.
std::int64_t PhaseHold::patience() const noexcept {
    return policy_.phase_periods_min << std::max(starts_in_vain_ - kStartsForFree, 0);
}

bool PhaseHold::is_lost() const noexcept {
    if (periods_ < patience()) return false;
    const bool is_mendable = std::abs(walk().count()) <= period_.count() * kWalkMaxPermille;
    return is_mendable && is_out();
}

Nanoseconds PhaseHold::walk() const noexcept {
    return periods_ > 0 ? Nanoseconds{off_ - off_at_start_} / periods_ : Nanoseconds{0};
}

Microseconds PhaseHold::start_off(Nanoseconds walk) const noexcept {
    const auto ahead = std::chrono::duration_cast<Microseconds>(-walk * kPeriodsAhead);
    return std::clamp(ahead, -policy_.phase_start_off, policy_.phase_start_off);
}

}  // namespace octoskin::node
