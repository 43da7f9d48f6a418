#include "firmware/core/phase_hold.hpp"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <utility>

namespace octoskin::node {

namespace {

// Oscillators are 6-7 % off. A period that is longer by more than this skips slots: PeriodTrim handles that.
constexpr std::int64_t kWalkMaxPermille = 150;
// A sensor that hardly drifts is started near its phase, since the direction of its drift is not known.
constexpr std::int64_t kPeriodsAhead = 32;
// The time of a first range is known to 0.1 or 0.2 ms; the mean of many is known better.
constexpr std::int64_t kFirstsAveraged = 16;

// A sensor's ready times become better known from range to range, for this many periods.
constexpr std::int64_t kFirstWithin = 6;

// A longer run gives the drift more precisely: it counts by the square of its periods. Earlier runs count no
// more than 64 periods would, so that a part that warms up is followed.
constexpr std::int64_t kWalkWeightMax = std::int64_t{64} * 64;

// A part's first run, before it is trimmed, and the runs after its first trims give no information about its
// oscillator.
constexpr int kStartsForFree = 4;
// 1,024 periods: a tenth of a percent of the readings.
constexpr int kDoublingsMax = 6;

// The longest time without a range, in periods: a period is known to 12 % before it is trimmed, and to 1 %
// afterwards.
constexpr std::int64_t kGapMax = 3;
constexpr std::int64_t kGapMaxTrimmed = 24;

Microseconds whole_us(Nanoseconds time) {
    return std::chrono::duration_cast<Microseconds>(time);
}

}  // namespace

void PhaseHold::restart(const Start& start) noexcept {
    if (start.period != start_.period) {
        firsts_ = 0;
        forget_walk();
        starts_in_vain_ = 0;
    }
    start_ = start;
    count_from(start.off);
    last_.reset();
    is_judged_ = is_in_vain_ = false;
}

void PhaseHold::observe(const TimeBracket& ready) noexcept {
    if (ready.width() > policy_.phase_known_within) return;
    const NodeTime at = ready.middle();
    if (!last_) {
        if (is_worth_waiting(ready)) return;
        begin(elapsed(start_.at.earliest, at));
    } else if (const Microseconds since = elapsed(*last_, at); is_distinguished(since)) {
        go_on(since);
    } else {
        count_from(off_ + nearest_to_zero(since));
    }
    last_ = at;
    if (!is_judged_ && periods_ >= policy_.phase_periods_min) judge_start();
}

/// Whether to wait for a range whose time is known better than this first one's.
bool PhaseHold::is_worth_waiting(const TimeBracket& ready) const noexcept {
    const Microseconds after = elapsed(start_.at.earliest, ready.middle());
    const bool is_soon = after.count() >= 0 && after <= kFirstWithin * start_.period;
    return is_soon && ready.width() > policy_.phase_first_known_within;
}

/// Whether, this long after the last range, it is certain which range this is: the sensor must not have
/// drifted as far as the place of another range.
bool PhaseHold::is_distinguished(Microseconds since_last) const noexcept {
    const std::int64_t periods_max = start_.is_trimmed ? kGapMaxTrimmed : kGapMax;
    return since_last.count() >= 0 && since_last <= periods_max * start_.period;
}

/// One range's time may be 0.1 ms off, so the predicted drift counts three times as much. A deviation that
/// the prediction excludes means another drift: that of a sensor which does not keep its rate.
void PhaseHold::go_on(Microseconds since_last) noexcept {
    const Microseconds strayed = nearest_to_zero(since_last);
    const std::int64_t periods = (since_last - strayed) / start_.period;
    periods_ += periods;
    off_ += strayed;
    const auto foreseen = smoothed_off_ + whole_us(walk() * periods);
    const bool is_foreseen = is_near(off_, foreseen);
    const Microseconds expected = off_at_first_ + whole_us(expected_walk_ * periods_);
    if (walk_weight_ > 0 && !(is_foreseen && is_near(off_, expected))) {
        forget_walk();
        count_in_vain();
    }
    smoothed_off_ = is_foreseen ? foreseen + (off_ - foreseen) / 4 : off_;
}

/// Whether both are equal, as well as ready times are known.
bool PhaseHold::is_near(Microseconds off, Microseconds other) const noexcept {
    return std::abs((off - other).count()) <= policy_.phase_known_within.count();
}

/// The drift is measured from here on.
void PhaseHold::count_from(Microseconds off) noexcept {
    off_ = off_at_first_ = smoothed_off_ = off;
    periods_ = 0;
}

/// The time from a start to the run's first ready time gives the place of the later ones. It is a property of
/// the part, and the same each time once its period is set.
void PhaseHold::begin(Microseconds first_after) noexcept {
    if (!start_.is_trimmed) return;
    // If a start was interrupted in the middle, its time is unknown.
    const bool is_start_known = start_.at.width() <= 2 * policy_.phase_known_within;
    if (!is_start_known || !is_distinguished(first_after)) {
        if (firsts_ > 0) count_from(off_ + nearest_to_zero(first_after - first_after_));
        return;
    }
    // Parts give the first range one period after the start. This may be a later one, if the times of earlier
    // ones were too uncertain: by then the sensor has drifted.
    periods_ = std::max((first_after + start_.period / 2) / start_.period - 1, std::int64_t{0});
    const Microseconds walked = whole_us(expected_walk_ * periods_);
    const Microseconds first = first_after - periods_ * start_.period - walked;
    firsts_ = std::min(firsts_ + 1, kFirstsAveraged);
    if (firsts_ == 1) first_after_ = first;
    const Microseconds more = nearest_to_zero(first - first_after_);
    first_after_ += more / firsts_;
    off_ += more - more / firsts_ + walked;
    smoothed_off_ = off_;
}

/// The same place within a period.
Microseconds PhaseHold::nearest_to_zero(Microseconds off) const noexcept {
    const Microseconds half = off.count() < 0 ? -start_.period / 2 : start_.period / 2;
    return off - (off + half) / start_.period * start_.period;
}

/// A sensor that keeps its rate drifts by half a register step per period. Because its times are uncertain it
/// may seem to drift by more. If it does not keep its rate it may seem to drift by a whole step.
void PhaseHold::judge_start() noexcept {
    is_judged_ = true;
    const Nanoseconds walked{std::abs(Nanoseconds{off_ - off_at_first_}.count())};
    const Nanoseconds step_each = start_.step * periods_;
    if (walked > step_each) {
        count_in_vain();
    } else if (!is_in_vain_ && walked * 6 <= step_each * 5) {
        // An unsteady sensor sometimes has drifted little, by chance.
        starts_in_vain_ = std::max(starts_in_vain_ - 1, 0);
    }
}

/// At most once per run.
void PhaseHold::count_in_vain() noexcept {
    if (std::exchange(is_in_vain_, true)) return;
    starts_in_vain_ = std::min(starts_in_vain_ + 1, kStartsForFree + kDoublingsMax);
}

bool PhaseHold::is_out() const noexcept {
    return std::abs(smoothed_off_.count()) > policy_.phase_tolerance.count();
}

/// The number of periods between two starts.
std::int64_t PhaseHold::patience() const noexcept {
    return policy_.phase_periods_min << std::max(starts_in_vain_ - kStartsForFree, 0);
}

bool PhaseHold::is_lost() const noexcept {
    if (periods_ < patience()) return false;
    const bool is_mendable = std::abs(walk().count()) <= start_.period.count() * kWalkMaxPermille;
    return is_mendable && is_out();
}

Nanoseconds PhaseHold::walk() const noexcept {
    const std::int64_t weight = walk_weight_ + periods_ * periods_;
    if (weight == 0) return Nanoseconds{0};
    const Nanoseconds walked_weighted = Nanoseconds{off_ - off_at_first_} * periods_;
    return (expected_walk_ * walk_weight_ + walked_weighted) / weight;
}

void PhaseHold::expect_walk(Nanoseconds walk) noexcept {
    expected_walk_ = walk;
    walk_weight_ = std::min(walk_weight_ + periods_ * periods_, kWalkWeightMax);
}

Microseconds PhaseHold::start_off(Nanoseconds walk) const noexcept {
    const Microseconds ahead = whole_us(-walk * kPeriodsAhead);
    return std::clamp(ahead, -policy_.phase_start_off, policy_.phase_start_off);
}

}  // namespace octoskin::node
