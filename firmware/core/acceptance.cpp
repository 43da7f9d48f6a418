#include "firmware/core/acceptance.hpp"

#include <algorithm>
#include <utility>

#include "common/range_pause.hpp"
#include "common/range_status.hpp"
#include "common/wire/messages.hpp"
#include "firmware/core/stream_gate.hpp"

namespace octoskin::node {

namespace {

/// The first range after a start cannot be checked for wrap-around, yet the device reports code 9, "complete"
/// (full API: user status 6). On the wire it gets code 19, which has exactly this meaning.
std::uint8_t status_on_wire(const vl53l1x::Measurement& measurement) noexcept {
    const bool is_first = measurement.stream_count == 0;
    if (is_first && measurement.device_status == kDeviceStatusComplete)
        return kDeviceStatusCompleteNoWrapCheck;
    return measurement.device_status;
}

bool is_after(NodeTime time, NodeTime other) noexcept {
    return !is_reached(time, other);
}

/// Maximum time from ready to read. The classical time field on the wire repeats after 262 ms. A reading is
/// half a timing budget old (at most 100 ms) when it becomes ready, and waits up to 50 ms to be sent.
constexpr Microseconds kReadLateMax{100'000};

/// The stream count repeats after this many ranges.
constexpr std::int64_t kStreamCycle = 128;

/// A range begins up to `kRangeOverheadMax` before its measuring window; the exact time is unknown.
TimeBracket begin_of(const TimeBracket& ready, Microseconds budget, Microseconds length_spread) noexcept {
    const TimeBracket window = shifted(ready, -budget);
    return {window.earliest - kRangeOverheadMax - length_spread, window.latest};
}

}  // namespace

Acceptance::Acceptance(StreamGate gate, Microseconds timing_budget, const Policy& policy) noexcept
    : gate_(gate), budget_(timing_budget), policy_(policy), tracker_(policy) {}

void Acceptance::restart(NodeTime started, Microseconds period, std::int32_t uncertainty_permille) noexcept {
    tracker_.restart(period, uncertainty_permille);
    last_stream_.reset();
    last_ready_.reset();
    last_accepted_ = started;
    forget_polls(started);
    results_refused_ = 0;
    was_stale_ = false;
    unproven_readings_ = policy_.unproven_readings_max;
    is_proven_ = false;
}

void Acceptance::on_not_ready(NodeTime asked) noexcept {
    not_ready_before_ = not_ready_at_;
    not_ready_at_ = asked;
    ++not_ready_polls_;
}

/// Forgets all polls: the next data was ready no sooner than `ready_since`.
void Acceptance::forget_polls(NodeTime ready_since) noexcept {
    not_ready_at_ = ready_since;
    not_ready_before_ = ready_since;
    not_ready_polls_ = 0;
}

void Acceptance::on_unreadable() noexcept {
    ++results_refused_;
    // The next read may return the same data. That became ready after the poll before last, even if the last
    // poll was altered in transit.
    forget_polls(not_ready_before_);
}

/// The first of several stale results more likely shows that a poll was altered than that a new range ended:
/// the next range is still to come.
void Acceptance::on_stale() noexcept {
    // If no poll before the newest ready time found the data not ready, that time is not reliable, either: a
    // faulty pin would mislead the tracker.
    if (unproven_readings_ > 0) tracker_.forget();
    if (has_accepted() && !std::exchange(was_stale_, true)) return;
    on_unreadable();
}

Admission Acceptance::judge(const ResultSeen& seen, const ZoneCycle& zones) noexcept {
    const vl53l1x::Measurement& measurement = seen.measurement;
    if (!is_new(measurement)) {
        on_stale();
        return Admission::refused;
    }
    const auto steps = steps_to(measurement.stream_count);
    if (is_count_in_doubt(steps, seen.read_end) || has_count_come_round(steps, seen.read_end))
        tracker_.forget();
    const std::uint32_t ranges = steps.value_or(results_refused_ + 1);
    const TimeBracket ready = ready_time(seen, ranges);

    is_proven_ = last_stream_.has_value();
    if (has_seen_not_ready()) {
        unproven_readings_ = 0;
    } else if (is_rhythm_proven()) {
        ++unproven_readings_;
    }
    last_stream_ = measurement.stream_count;
    last_ready_ = ready.earliest;
    last_accepted_ = seen.read_end;
    forget_polls(seen.ready_seen);
    results_refused_ = 0;
    was_stale_ = false;

    // The extra length of a range may lie before its measuring window or after it.
    const Microseconds spread = policy_.length_spread();
    reading_ = {.zone = zones.in_force(begin_of(ready, budget_, spread)),
                .device_status = status_on_wire(measurement),
                .range_mm = measurement.range_mm,
                .sigma_quarter_mm = measurement.sigma_quarter_mm,
                .peak_signal = measurement.peak_signal,
                .ambient = measurement.ambient,
                .capture = ready.middle() - budget_ / 2 - spread / 2,
                .capture_bound = ready.half_width() + (spread + Microseconds{1}) / 2};
    const bool is_dated = reading_.capture_bound <= policy_.capture_bound_max &&
                          elapsed(ready.latest, seen.read_end) <= kReadLateMax;
    return is_dated && reading_.zone != wire::kZoneUnknown ? Admission::accepted : Admission::undated;
}

/// After a start there is no stream count to compare with, and the result may be left over from the previous
/// run. It is new if its data was seen to become ready: by two polls, since one may have been altered.
bool Acceptance::is_new(const vl53l1x::Measurement& measurement) const noexcept {
    if (!last_stream_) return is_next_new();
    return passes(gate_, *last_stream_, measurement.stream_count);
}

std::optional<std::uint8_t> Acceptance::steps_to(std::uint8_t stream_count) const noexcept {
    if (gate_ != StreamGate::advanced || !last_stream_) return std::nullopt;
    return stream_steps(*last_stream_, stream_count);
}

/// It is in doubt which range was read in three cases. There is no stream count, and the next range may have
/// ended before the read. Or, after results that were not usable, no poll found the data not ready. Or only
/// one poll did, and the stream count indicates another range.
bool Acceptance::is_count_in_doubt(std::optional<std::uint8_t> steps, NodeTime read_end) const noexcept {
    const std::uint32_t seen = results_refused_ + 1;
    if (!steps && last_ready_ && elapsed(*last_ready_, read_end) > (4 * seen + 3) * tracker_.period() / 4)
        return true;
    if (results_refused_ == 0) return false;
    if (!has_seen_not_ready()) return true;
    return not_ready_polls_ == 1 && steps && *steps != seen;
}

/// Whether the stream count may have wrapped since the last read (it repeats after 4 s at 30 Hz), so that it
/// does not give the number of ranges.
bool Acceptance::has_count_come_round(std::optional<std::uint8_t> steps, NodeTime read_end) const noexcept {
    if (!steps || !last_ready_) return false;
    return elapsed(*last_ready_, read_end) > (*steps + kStreamCycle / 2) * tracker_.period();
}

/// When the data became ready, according to the polls and the rhythm.
TimeBracket Acceptance::ready_time(const ResultSeen& seen, std::uint32_t ranges) noexcept {
    const auto predicted = tracker_.predict(ranges);
    const bool is_overdue = predicted && is_after(not_ready_at_, predicted->latest);
    const bool is_close =
        not_ready_polls_ >= 2 && elapsed(not_ready_before_, not_ready_at_) <= policy_.close_polls_accepted;
    const bool is_poll_accepted = (is_close || is_lone_poll_accepted(predicted)) && !is_overdue;
    const NodeTime not_ready = is_poll_accepted ? not_ready_at_ : not_ready_before_;
    // Only one poll found the data overdue. Either that poll was altered, or the sensor lost its rhythm.
    if (is_overdue && !is_after(not_ready, predicted->latest))
        return tracker_.relearn({later_of(not_ready, predicted->earliest), seen.read_end}, ranges);
    // Ready earlier than predicted: the sensor is ahead of its rhythm, or its pin is faulty. The rhythm is
    // dropped; a wrong one would otherwise never be corrected.
    const bool is_next = results_refused_ == 0 && ranges == 1;
    if (is_next && predicted && is_after(predicted->earliest, seen.ready_seen)) {
        tracker_.forget();
        return tracker_.observe({not_ready_before_, not_ready_polls_ >= 2 ? seen.ready_seen : seen.read_end},
                                ranges);
    }
    // Data stays ready until it is cleared, but a later range overwrites it. The polls then saw the ready
    // time of an earlier range than the one read. Without a poll that found the data not ready, the ready
    // time is unknown, unless the rhythm is proven and this range directly follows the last one read.
    const TimeBracket polled{not_ready, seen.ready_seen};
    const TimeBracket until_read{not_ready, seen.read_end};
    // The count begins at 0 after a start and never returns to 0.
    const bool is_counted_next = gate_ == StreamGate::advanced &&
                                 (has_accepted() ? predicted && is_next : seen.measurement.stream_count == 0);
    const bool is_of_this = is_read_of(polled, predicted, seen.read_end, is_counted_next);
    const bool is_seen_low = not_ready_polls_ >= (is_poll_accepted ? 1U : 2U);
    const bool is_known_low =
        is_next && !was_stale_ && is_rhythm_proven() && is_lone_poll_accepted(predicted);
    const bool is_edge_seen = (is_seen_low || is_known_low) && is_of_this;
    return tracker_.observe(is_edge_seen ? polled : until_read, ranges);
}

/// Whether the result read is the data that became ready within `polled`. If the read was late, the result
/// may be that of the next range. Then only the stream count can decide, or a prediction that excludes the
/// next range.
bool Acceptance::is_read_of(const TimeBracket& polled, const std::optional<TimeBracket>& predicted,
                            NodeTime read_end, bool is_counted_next) const noexcept {
    if (predicted && !intersection(polled, *predicted)) return false;
    if (is_counted_next) return true;
    const NodeTime next_earliest = polled.earliest + tracker_.period() * 3 / 4;
    if (!is_reached(next_earliest, read_end)) return true;
    return predicted && !intersection({next_earliest, read_end}, *predicted);
}

bool Acceptance::is_lone_poll_accepted(const std::optional<TimeBracket>& predicted) const noexcept {
    return predicted && known_width(*predicted) <= policy_.lone_poll_accepted;
}

bool Acceptance::must_poll_punctually() const noexcept {
    const auto predicted = next_ready();
    return !predicted || known_width(*predicted) > policy_.punctual_above;
}

bool Acceptance::wants_poll_confirmed() const noexcept {
    const auto predicted = next_ready();
    // Where polls are far apart, confirming each of them costs more than it gains.
    const bool is_near = predicted && known_width(*predicted) <= 3 * policy_.lone_poll_accepted;
    return is_near && !is_lone_poll_accepted(predicted) && is_after(not_ready_at_, predicted->earliest) &&
           elapsed(not_ready_before_, not_ready_at_) > policy_.lone_poll_accepted;
}

bool Acceptance::wants_ready_confirmed() const noexcept {
    const auto predicted = next_ready();
    // The wider the bracket, the larger the error that one altered poll causes in the ready time and in the
    // period.
    return !has_accepted() || !predicted || known_width(*predicted) > policy_.lone_poll_accepted ||
           is_after(not_ready_at_, predicted->latest);
}

std::optional<TimeBracket> Acceptance::next_ready() const noexcept {
    return tracker_.predict(results_refused_ + 1);
}

std::optional<NodeTime> Acceptance::next_range_begin() const noexcept {
    const auto next = next_ready();
    if (!next) return std::nullopt;
    return begin_of(*next, budget_, policy_.length_spread()).earliest;
}

/// The width of a predicted bracket without the jitter of single ranges: how well the sensor's grid is known.
Microseconds Acceptance::known_width(const TimeBracket& predicted) const noexcept {
    return predicted.width() - policy_.width_of_jitter();
}

bool Acceptance::is_silent(NodeTime now) const noexcept {
    return elapsed(last_accepted_, now) > policy_.stale_after_periods * tracker_.period();
}

}  // namespace octoskin::node
