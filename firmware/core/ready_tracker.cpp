#include "firmware/core/ready_tracker.hpp"

#include <algorithm>
#include <cassert>

namespace octoskin::node {

namespace {

constexpr std::int64_t kQ8 = 256;
// The period is measured over windows of this many ranges: long enough for 0.03 % at 33 ms, short enough to
// follow a part that warms up. A window whose start is known only half as well as the present is ended
// before.
constexpr std::uint32_t kWindowSlots = 32;
// How much the period may change within a window, and from one window to the next.
constexpr std::int64_t kDriftPerWindowPpm = 300;
// A single range may come this much earlier than predicted before the whole rhythm is doubted.
constexpr Microseconds kEarlySlip{1'000};

constexpr std::int64_t floor_q8(std::int64_t q8) {
    return q8 >> 8;
}
constexpr std::int64_t ceil_q8(std::int64_t q8) {
    return (q8 + kQ8 - 1) >> 8;
}

}  // namespace

ReadyTracker::ReadyTracker(const Policy& policy) noexcept : policy_(policy) {}

void ReadyTracker::restart(Microseconds expected, std::int32_t uncertainty_permille) noexcept {
    expected_ = expected;
    grid_.reset();
    assume_period(expected, expected, uncertainty_permille);
}

void ReadyTracker::forget() noexcept {
    grid_.reset();
    assume_period(expected_, expected_, policy_.period_unknown_permille);
}

void ReadyTracker::assume_period(Microseconds shortest, Microseconds longest,
                                 std::int32_t uncertainty_permille) noexcept {
    observed_ = 0;
    slots_missed_in_row_ = 0;
    shortest_q8_ = shortest.count() * kQ8 * (1000 - uncertainty_permille) / 1000;
    longest_q8_ = longest.count() * kQ8 * (1000 + uncertainty_permille) / 1000;
}

TimeBracket ReadyTracker::grid_after(std::uint32_t slots) const noexcept {
    const auto n = static_cast<std::int64_t>(slots);
    return {grid_->earliest + Microseconds{floor_q8(shortest_q8_ * n)},
            grid_->latest + Microseconds{ceil_q8(longest_q8_ * n)}};
}

std::optional<TimeBracket> ReadyTracker::predict(std::uint32_t ranges) const noexcept {
    if (!grid_) return std::nullopt;
    return widened(grid_after(ranges), policy_.ready_jitter);
}

TimeBracket ReadyTracker::observe(const TimeBracket& seen, std::uint32_t ranges) noexcept {
    ++observed_;
    if (!grid_) {
        grid_ = widened(seen, policy_.ready_jitter);
        open_window();
        return seen;
    }
    if (const auto ready = fit(seen, ranges)) {
        slots_missed_in_row_ = 0;
        return *ready;
    }
    // A sensor whose period is too close to its budget skips a start slot now and then: the grid holds, with
    // one place left empty. Twice in a row it is a sensor at half its rate. (If the bracket is wider than
    // half a period, it could be any of several places.)
    if (slots_missed_in_row_ == 0 && seen.width() < expected_ / 2) {
        if (const auto ready = fit(seen, ranges + 1)) {
            ++slots_missed_in_row_;
            return *ready;
        }
    }
    return relearn(seen, ranges);
}

/// Takes `seen` as the ready time `slots` places later. Empty, and nothing is changed, if it contradicts the
/// grid.
std::optional<TimeBracket> ReadyTracker::fit(const TimeBracket& seen, std::uint32_t slots) noexcept {
    const TimeBracket place = grid_after(slots);
    const auto ready = intersection(seen, widened(place, policy_.ready_jitter));
    const auto narrowed = intersection(widened(seen, policy_.ready_jitter), place);
    if (!ready || !narrowed) return std::nullopt;
    grid_ = narrowed;
    window_slots_ += slots;
    refine_period();
    return ready;
}

/// Begins a new grid at the present range. Its period is the expected one again, or may be twice that if a
/// range was due in between and did not come.
TimeBracket ReadyTracker::relearn(const TimeBracket& seen, std::uint32_t ranges) noexcept {
    TimeBracket ready = seen;
    const TimeBracket predicted = *predict(ranges);
    if (is_reached(predicted.earliest - kEarlySlip, seen.latest) &&
        is_reached(seen.latest, predicted.latest)) {
        ready.earliest = later_of(seen.earliest, predicted.earliest - kEarlySlip);
    }
    const Microseconds since_last = elapsed(grid_->middle(), ready.middle());
    const bool is_doubled =
        since_last > expected_ * ranges * 17 / 10 && since_last < expected_ * ranges * 23 / 10;
    assume_period(expected_, is_doubled ? expected_ * 2 : expected_, policy_.period_unknown_permille);
    observed_ = 1;
    grid_ = widened(ready, policy_.ready_jitter);
    open_window();
    return ready;
}

void ReadyTracker::refine_period() noexcept {
    const auto slots = static_cast<std::int64_t>(window_slots_);
    const PeriodQ8 drift = longest_q8_ * kDriftPerWindowPpm / 1'000'000;
    // The window gives its average; the present period may have changed.
    const PeriodQ8 shortest = elapsed(window_start_.latest, grid_->earliest).count() * kQ8 / slots - drift;
    const PeriodQ8 longest = elapsed(window_start_.earliest, grid_->latest).count() * kQ8 / slots + 1 + drift;
    shortest_q8_ = std::max(shortest_q8_, shortest);
    longest_q8_ = std::min(longest_q8_, longest);
    // By induction over the window the grid is never further from its start than `slots` of the longest
    // period, so the shortest period by the window stays below it. Rounding costs less than the drift adds.
    assert(shortest_q8_ <= longest_q8_);
    const bool is_start_outdone = window_start_.width() > 2 * grid_->width();
    if (window_slots_ < kWindowSlots && !is_start_outdone) return;
    shortest_q8_ -= drift;
    longest_q8_ += drift;
    open_window();
}

void ReadyTracker::open_window() noexcept {
    window_start_ = *grid_;
    window_slots_ = 0;
}

Microseconds ReadyTracker::period() const noexcept {
    return Microseconds{(shortest_q8_ + longest_q8_) / (2 * kQ8)};
}

std::optional<MeasuredPeriod> ReadyTracker::measured_period() const noexcept {
    if (observed_ <= policy_.trim_edges_min) return std::nullopt;
    return MeasuredPeriod{period(), Microseconds{ceil_q8((longest_q8_ - shortest_q8_ + 1) / 2) + 1}};
}

}  // namespace octoskin::node
