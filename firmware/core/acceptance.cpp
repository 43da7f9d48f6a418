#include "firmware/core/acceptance.hpp"

#include <algorithm>

#include "common/range_status.hpp"
#include "common/wire/messages.hpp"
#include "firmware/core/stream_gate.hpp"

namespace octoskin::node {

namespace {

/// The first range after a start cannot be checked for wrap-around; the device itself says "complete" all the
/// same (full API: user status 6). On the wire that is the code which means just this.
std::uint8_t status_on_wire(const vl53l1x::Measurement& measurement) noexcept {
    const bool is_first = measurement.stream_count == 0;
    if (is_first && measurement.device_status == kDeviceStatusComplete)
        return kDeviceStatusCompleteNoWrapCheck;
    return measurement.device_status;
}

}  // namespace

Acceptance::Acceptance(StreamGate gate, Microseconds timing_budget, const Policy& policy) noexcept
    : gate_(gate), budget_(timing_budget), policy_(policy), tracker_(policy) {}

void Acceptance::restart(NodeTime started, Microseconds period, std::int32_t uncertainty_permille) noexcept {
    tracker_.restart(period, uncertainty_permille);
    last_stream_.reset();
    last_ready_.reset();
    last_accepted_ = started;
    not_ready_at_ = started;
    has_seen_not_ready_ = false;
    results_refused_ = 0;
    is_proven_ = false;
}

void Acceptance::on_not_ready(NodeTime asked) noexcept {
    not_ready_at_ = asked;
    has_seen_not_ready_ = true;
}

void Acceptance::on_unreadable() noexcept {
    ++results_refused_;
    has_seen_not_ready_ = false;
}

Verdict Acceptance::judge(const ResultSeen& seen, const ZoneCycle& zones) noexcept {
    const vl53l1x::Measurement& measurement = seen.measurement;
    if (!is_new(measurement)) {
        on_unreadable();
        return Verdict::refused;
    }
    // Who could not read the last results and saw no data become ready does not know which range this is.
    if (results_refused_ > 0 && !has_seen_not_ready_) tracker_.forget();
    const std::uint32_t ranges = ranges_since_last(steps_to(measurement.stream_count), seen.read_end);
    const TimeBracket ready = tracker_.observe(ready_bracket(seen, ranges), ranges);

    is_proven_ = last_stream_.has_value();
    last_stream_ = measurement.stream_count;
    last_ready_ = ready.earliest;
    last_accepted_ = seen.read_end;
    not_ready_at_ = seen.ready_seen;
    has_seen_not_ready_ = false;
    results_refused_ = 0;

    reading_ = {.zone = zones.in_force(shifted(ready, -budget_)),
                .device_status = status_on_wire(measurement),
                .range_mm = measurement.range_mm,
                .sigma_quarter_mm = measurement.sigma_quarter_mm,
                .peak_signal = measurement.peak_signal,
                .ambient = measurement.ambient,
                .capture = ready.middle() - budget_ / 2,
                .capture_bound = ready.half_width()};
    const bool is_dated = reading_.capture_bound <= policy_.capture_bound_max;
    return is_dated && reading_.zone != wire::kZoneUnknown ? Verdict::accepted : Verdict::undated;
}

/// After a start there is no stream count to compare with, and the result may still be one of the run before,
/// unless its data was seen to become ready.
bool Acceptance::is_new(const vl53l1x::Measurement& measurement) const noexcept {
    if (!last_stream_) return has_seen_not_ready_;
    return passes(gate_, *last_stream_, measurement.stream_count);
}

std::optional<std::uint8_t> Acceptance::steps_to(std::uint8_t stream_count) const noexcept {
    if (gate_ != StreamGate::advanced || !last_stream_) return std::nullopt;
    return stream_steps(*last_stream_, stream_count);
}

std::uint32_t Acceptance::ranges_since_last(std::optional<std::uint8_t> steps,
                                            NodeTime read_end) const noexcept {
    if (steps) return *steps;
    const std::uint32_t seen = results_refused_ + 1;
    if (has_seen_not_ready_ || !last_ready_) return seen;
    // Without a count that tells, time must: as many ranges as fit since the last ready time.
    const Microseconds period = tracker_.period();
    const std::int64_t fitting = (elapsed(*last_ready_, read_end) + period / 16) / period;
    return static_cast<std::uint32_t>(std::max<std::int64_t>(seen, fitting));
}

TimeBracket Acceptance::ready_bracket(const ResultSeen& seen, std::uint32_t ranges) const noexcept {
    // Data stays ready until cleared, but a later range overwrites it: then the poll saw the edge of an
    // earlier range than the one read.
    // A poll that was never answered "not ready" proves nothing about when.
    const TimeBracket polled{not_ready_at_, seen.ready_seen};
    const TimeBracket until_read{not_ready_at_, seen.read_end};
    if (!has_seen_not_ready_) return until_read;
    const auto predicted = tracker_.predict(ranges);
    return !predicted || intersection(polled, *predicted) ? polled : until_read;
}

std::optional<TimeBracket> Acceptance::next_ready() const noexcept {
    return tracker_.predict(results_refused_ + 1);
}

std::optional<NodeTime> Acceptance::next_range_begin() const noexcept {
    const auto next = next_ready();
    if (!next) return std::nullopt;
    return next->earliest - budget_;
}

bool Acceptance::is_silent(NodeTime now) const noexcept {
    return elapsed(last_accepted_, now) > policy_.stale_after_periods * tracker_.period();
}

}  // namespace octoskin::node
