#include "firmware/core/ranging.hpp"

#include <cassert>

#include "common/range_pause.hpp"
#include "firmware/core/sensor_fault.hpp"

namespace octoskin::node {

namespace {

using wire::SensorFault;

// A single poll that finds no result of a range under way at the stop may have been altered in transit.
constexpr std::uint8_t kLooksForLastResult = 2;

constexpr std::uint8_t kStartsPutOffMax = 3;

}  // namespace

Ranging::Ranging(vl53l1x::Device& device, const SensorConfig& config, const RangingRules& rules,
                 const Policy& policy, const PhaseClock& clock, NodeTime node_began) noexcept
    : device_(device),
      config_(config),
      rules_(rules),
      policy_(policy),
      clock_(clock),
      polls_(rules.i2c_hz, policy),
      acceptance_(rules.stream_gate, Microseconds{std::int64_t{config.timing_budget_ms} * 1'000}, policy),
      trim_(Microseconds{std::int64_t{config.inter_measurement_ms} * 1'000}, policy),
      phase_(policy),
      range_length_(budget()),
      zones_(config.zone_count, rules.zone_guard),
      checks_(policy),
      first_start_(node_began + policy.first_starts) {}

void Ranging::begin(NodeTime now) {
    is_stop_requested_ = false;
    is_trim_due_ = false;
    is_period_set_ = false;
    start_off_ = Microseconds{0};
    fault_ = SensorFault::none;
    start_step(Step::setting_period, now);
}

void Ranging::begin_restart(NodeTime now) {
    is_period_set_ = false;
    is_stop_requested_ = false;
    is_trim_due_ = true;
    start_step(Step::stopping, now);
}

void Ranging::request_stop(NodeTime now) noexcept {
    is_stop_requested_ = true;
    if (is_waiting()) step_due_ = now;
}

void Ranging::set_period(Microseconds period, NodeTime now) noexcept {
    trim_.set_configured(period);
    is_period_set_ = false;
    start_off_ = Microseconds{0};
    is_trim_due_ = true;
    if (is_waiting()) step_due_ = now;
}

void Ranging::on_hint(NodeTime now) noexcept {
    const bool may_be_ready = step_ == Step::awaiting_data && is_reached(ready_from_, now);
    if (!may_be_ready && step_ != Step::reading) return;
    has_hint_ = true;
    // A sensor that is already due keeps its place: the one that has waited longest is next.
    if (may_be_ready) step_due_ = earlier_of(step_due_, now);
}

bool Ranging::is_waiting() const noexcept {
    return step_ == Step::awaiting_phase || step_ == Step::awaiting_data;
}

Ranging::Result Ranging::advance(NodeTime now) {
    if (step_ == Step::draining) return {.event = on_drained(now)};
    start_due_step(now);
    if (is_waiting()) return {};

    switch (device_.poll(now)) {
        case vl53l1x::Progress::busy:
            if (const auto wake = device_.wake_time(); wake && !is_reached(*wake, now)) {
                step_due_ = *wake;
                return {};
            }
            return {.bus = BusUse::keeps};
        case vl53l1x::Progress::done: {
            const Event event = on_step_done(now);
            // Otherwise other sensors would have the bus for longer than the pause between two ranges.
            return {.bus = step_ == Step::writing_zone ? BusUse::keeps : BusUse::releases, .event = event};
        }
        case vl53l1x::Progress::failed:
            return {.event = on_step_failed(device_.error(), now)};
        case vl53l1x::Progress::idle:
            assert(false && "an operation is begun before it is polled");
            break;
    }
    return {};
}

/// A step that waits for a time changes to the next step once it is due.
void Ranging::start_due_step(NodeTime now) {
    if (!is_waiting()) return;
    if (is_stop_requested_ || is_trim_due_) {
        start_step(Step::stopping, now);
    } else if (is_too_late_to_start(now)) {
        ++starts_put_off_;
        start_step(Step::awaiting_phase, now);
    } else {
        is_hinted_ = std::exchange(has_hint_, false);
        start_step(step_ == Step::awaiting_phase ? Step::starting : Step::reading, now);
    }
}

/// A sensor delayed by the bus starts a period later rather than out of its phase; at most kStartsPutOffMax
/// times in a row.
bool Ranging::is_too_late_to_start(NodeTime now) const noexcept {
    return step_ == Step::awaiting_phase && rules_.holds_phases && starts_put_off_ < kStartsPutOffMax &&
           elapsed(phase_due_, now) > policy_.phase_start_slack;
}

void Ranging::start_step(Step step, NodeTime now) {
    step_ = step;
    step_due_ = now;
    step_began_ = now;
    switch (step) {
        case Step::setting_period:
            device_.begin_set_inter_measurement(trim_.commanded());
            break;
        case Step::checking_period:
            device_.begin_verify(vl53l1x::kTimingGroup);
            break;
        case Step::awaiting_phase:
            phase_due_ = next_phase(now);
            // The bus delays it, on average by as much as it was early.
            step_due_ = rules_.holds_phases ? phase_due_ - policy_.phase_start_slack : phase_due_;
            break;
        case Step::starting:
            device_.begin_start();
            break;
        case Step::reading:
            device_.begin_read(acceptance_.wants_ready_confirmed());
            break;
        case Step::reading_last:
            device_.begin_read();
            break;
        case Step::writing_zone:
            device_.begin_set_zone(config_.zones[zones_.next()]);
            break;
        case Step::checking_zone:
            device_.begin_verify_zone();
            break;
        case Step::checking_steering:
            device_.begin_verify(checks_.group());
            break;
        case Step::stopping:
            stop_began_ = now;
            device_.begin_stop();
            break;
        case Step::draining:
            drain(now);
            break;
        case Step::idle:
        case Step::awaiting_data:
            break;
    }
}

Ranging::Event Ranging::on_step_done(NodeTime now) {
    switch (step_) {
        case Step::setting_period:
            start_step(Step::checking_period, now);
            break;
        case Step::checking_period:
            start_step(Step::awaiting_phase, now);
            break;
        case Step::starting:
            on_started(now);
            break;
        case Step::reading:
            return on_read(now);
        case Step::reading_last:
            return on_last_read(now);
        case Step::writing_zone:
            zones_.written({step_began_, now});
            start_step(Step::checking_zone, now);
            break;
        case Step::checking_zone:
            check_or_await(now);
            break;
        case Step::checking_steering:
            checks_.on_clean();
            await_next_result(now);
            break;
        case Step::stopping:
            start_step(Step::draining, now);
            break;
        case Step::idle:
        case Step::awaiting_phase:
        case Step::awaiting_data:
        case Step::draining:
            break;
    }
    return Event::none;
}

Ranging::Event Ranging::on_step_failed(vl53l1x::Error error, NodeTime now) {
    const Step step = step_;
    const bool is_bad_result =
        error == vl53l1x::Error::reads_disagree || error == vl53l1x::Error::implausible_block;
    if (step == Step::reading && is_bad_result) {
        acceptance_.on_unreadable();
        return refuse(sensor_fault(error), now);
    }
    if (step == Step::reading_last && is_bad_result) {
        fault_ = sensor_fault(error);
        start_anew(now);
        return Event::refused;
    }
    const Event failed = fail(sensor_fault(error));
    if (step == Step::checking_steering && error == vl53l1x::Error::config_mismatch)
        suspect_readings_ = checks_.suspects();
    return failed;
}

/// Where phases are held, starts are frequent. There a range under way at the stop is read, too, and a sensor
/// that is known to have had none is not waited for.
void Ranging::drain(NodeTime now) {
    looks_left_ = 0;
    if (is_between_ranges(now)) {
        step_due_ = now;
        return;
    }
    step_due_ = now + budget() + kRangeOverheadMax;
    const auto next = acceptance_.next_ready();
    const bool is_rhythm_known =
        next && !acceptance_.has_refused() && next->width() <= policy_.phase_known_within;
    if (!rules_.holds_phases || !is_rhythm_known || is_reached(next->earliest, now)) return;
    last_expected_ = *next;
    looks_left_ = kLooksForLastResult;
}

Ranging::Event Ranging::on_drained(NodeTime now) {
    if (is_stop_requested_) {
        step_ = Step::idle;
        return Event::stopped;
    }
    if (looks_left_ > 0) {
        --looks_left_;
        start_step(Step::reading_last, now);
    } else {
        start_anew(now);
    }
    return Event::none;
}

/// A result is a reading like any other; if there is none, no range was under way.
Ranging::Event Ranging::on_last_read(NodeTime now) {
    if (!device_.has_measurement()) {
        acceptance_.on_not_ready(polls_.not_ready_until(step_began_));
        if (looks_left_ == 0) range_length_.on_none_begun(stop_began_, last_expected_);
        return on_drained(now);
    }
    const Admission verdict = judge_result(now);
    start_anew(now);
    switch (verdict) {
        case Admission::accepted:
            checks_.on_reading();
            return Event::reading;
        case Admission::undated:
            return Event::undated;
        case Admission::refused:
            break;
    }
    fault_ = SensorFault::stale_stream;
    return Event::refused;
}

void Ranging::start_anew(NodeTime now) {
    is_trim_due_ = false;
    start_step(std::exchange(is_period_set_, false) ? Step::awaiting_phase : Step::setting_period, now);
}

void Ranging::on_started(NodeTime now) {
    acceptance_.restart(step_began_, trim_.configured(), trim_.uncertainty_permille());
    phase_.restart({.at = {step_began_, now},
                    .off = start_off_ + elapsed(phase_due_, step_began_),
                    .period = trim_.configured(),
                    .step = device_.period_step().value_or(Nanoseconds{0}),
                    .is_trimmed = trim_.is_refined()});
    starts_put_off_ = 0;
    zones_.settle();
    ready_from_ = polls_.first_poll_after_start(phase_due_, budget());
    // Observed: parts give the first result one period after the start.
    const NodeTime expected = phase_due_ + trim_.configured();
    const Microseconds uncertainty = trim_.configured() * trim_.uncertainty_permille() / 1'000;
    first_expected_ = widened({expected, expected}, uncertainty);
    early_until_ = first_expected_.earliest - policy_.repoll_max;
    if (rules_.holds_phases && comes_as_expected_) ready_from_ = early_until_;
    // One poll before that: data that is there at once is not of this run.
    await_data(now + policy_.repoll_max);
    ranges_ = 0;
    has_hint_ = was_announced_ = false;
}

Ranging::Event Ranging::on_read(NodeTime now) {
    if (!device_.has_measurement()) {
        if (!device_.have_polls_disagreed()) acceptance_.on_not_ready(polls_.not_ready_until(step_began_));
        // A sensor whose results had to be refused is not one that gives none.
        const SensorFault silence = acceptance_.has_refused() ? fault_ : SensorFault::no_data_ready;
        if (acceptance_.is_silent(now)) return fail(silence);
        await_data(has_hint_ ? now : repoll(now));
        return Event::none;
    }
    note_announcement();
    switch (judge_result(now)) {
        case Admission::accepted:
            after_result(now);
            return Event::reading;
        case Admission::undated:
            after_result(now);
            return Event::undated;
        case Admission::refused:
            break;
    }
    return refuse(SensorFault::stale_stream, now);
}

Admission Ranging::judge_result(NodeTime now) {
    const ResultSeen seen{.measurement = device_.measurement(),
                          .ready_seen = polls_.ready_by(device_.ready_seen()),
                          .read_end = now};
    return acceptance_.judge(seen, zones_);
}

/// The next poll after one that found nothing.
NodeTime Ranging::repoll(NodeTime now) const noexcept {
    if (acceptance_.wants_poll_confirmed()) return now;
    const auto predicted = acceptance_.next_ready();
    return predicted ? polls_.repoll(*predicted, acceptance_.period(), now)
                     : polls_.poll_after_start(ready_from_, first_expected_, acceptance_.period(),
                                               {step_began_, now});
}

Ranging::Event Ranging::refuse(SensorFault fault, NodeTime now) {
    fault_ = fault;
    if (acceptance_.is_silent(now)) return fail(fault);
    await_next_result(now);
    return Event::refused;
}

Ranging::Event Ranging::fail(SensorFault fault) {
    fault_ = fault;
    suspect_readings_ = 0;
    step_ = Step::idle;
    return Event::failed;
}

void Ranging::after_result(NodeTime now) {
    checks_.on_reading();
    const Reading& judged = acceptance_.reading();
    zones_.note_range(judged.capture - judged.capture_bound - budget() / 2 - kRangeOverheadMax);
    if (ranges_ == 0) comes_as_expected_ = first_expected_.contains(judged.capture + budget() / 2);
    ++ranges_;
    is_trim_due_ = is_trim_due_ || is_restart_wanted(now);
    if (is_zone_write_due(now)) {
        start_step(Step::writing_zone, now);
    } else {
        check_or_await(now);
    }
}

/// For another period, or to return to its phase.
bool Ranging::is_restart_wanted(NodeTime now) noexcept {
    const auto measured = acceptance_.measured_period();
    if (measured && trim_.is_judged_after(ranges_) && trim_.wants_trim(*measured, now)) {
        start_off_ = Microseconds{0};
        phase_.forget_walk();
        return true;
    }
    if (!rules_.holds_phases) return false;
    const Reading& judged = acceptance_.reading();
    const NodeTime ready = judged.capture + budget() / 2;
    phase_.observe(widened({ready, ready}, judged.capture_bound));
    const auto step = device_.period_step();
    if (!step || !phase_.is_lost()) return false;
    const Microseconds commanded = trim_.commanded();
    const Nanoseconds walk = trim_.refine(phase_.walk(), *step);
    phase_.expect_walk(walk);
    start_off_ = phase_.start_off(walk);
    is_period_set_ = trim_.commanded() == commanded;
    return true;
}

void Ranging::check_or_await(NodeTime now) {
    if (checks_.is_due()) {
        start_step(Step::checking_steering, now);
    } else {
        await_next_result(now);
    }
}

void Ranging::await_next_result(NodeTime now) {
    const auto predicted = acceptance_.next_ready();
    ready_from_ = predicted ? polls_.first_poll(*predicted) : now;
    await_data(is_trim_due_ || is_stop_requested_ ? stop_time(now)
               : predicted                        ? next_poll(*predicted)
                                                  : polls_.blind_poll(now, acceptance_.period(), now));
}

void Ranging::await_data(NodeTime due) noexcept {
    step_ = Step::awaiting_data;
    step_due_ = due;
    // Only for the first data: half the clock's range later that time would seem to be in the future.
    is_early_ = !acceptance_.has_accepted() && !acceptance_.next_ready() && acceptance_.is_next_new() &&
                !is_reached(early_until_, due);
    is_poll_punctual_ = !is_early_ && acceptance_.must_poll_punctually();
}

/// The line announced this data if it fell while data was awaited, or while the sensor was polled.
void Ranging::note_announcement() noexcept {
    was_announced_ = is_hinted_ || has_hint_;
    has_confirmed_ = has_confirmed_ || was_announced_;
    has_hint_ = false;
}

/// A poll in the middle of the bracket gives the most information, whatever the answer. One just before the
/// bracket only shows that the sensor keeps its rhythm, which is needed only now and then. Where a line
/// announces data, one poll is enough until the bracket, which grows from range to range, has become too
/// wide.
NodeTime Ranging::next_poll(const TimeBracket& predicted) const noexcept {
    const Microseconds width = predicted.width() - policy_.width_of_jitter();
    if (acceptance_.has_refused() || width > policy_.known_width_max) return polls_.first_poll(predicted);
    if (was_announced_ && width <= policy_.hinted_width_max) return polls_.poll_after_hint(predicted);
    const bool is_proven = was_announced_ || acceptance_.is_rhythm_proven();
    return is_proven ? polls_.poll_within(predicted, acceptance_.period()) : polls_.first_poll(predicted);
}

bool Ranging::is_zone_write_due(NodeTime now) const noexcept {
    const auto begin = acceptance_.next_range_begin();
    return zones_.is_cycling() && !is_trim_due_ && begin && zones_.fits_before(*begin, now);
}

/// Only where phases are held: elsewhere a stop is not urgent.
bool Ranging::is_between_ranges(NodeTime now) const noexcept {
    const auto next = acceptance_.next_ready();
    return rules_.holds_phases && is_trim_due_ && next && range_length_.is_before(now, next->earliest);
}

NodeTime Ranging::stop_time(NodeTime now) const noexcept {
    const bool is_delayed = rules_.holds_phases && is_trim_due_ && !is_between_ranges(now);
    return is_delayed ? now + policy_.phase_stop_delay : now;
}

bool Ranging::can_restart() const noexcept {
    return fault_ == SensorFault::no_data_ready || fault_ == SensorFault::stale_stream ||
           fault_ == SensorFault::reads_disagree || fault_ == SensorFault::implausible_block;
}

std::int32_t Ranging::period_error_permille() const noexcept {
    const auto measured = acceptance_.measured_period();
    return measured ? trim_.error_permille(measured->value) : 0;
}

/// Sensors start at whole periods of the node's clock plus their phase; the first time once all of them had
/// the time to be brought up.
NodeTime Ranging::next_phase(NodeTime now) const noexcept {
    // After a full wrap of the clock it looks as if it were still to come, for this short while.
    const Microseconds until_first = elapsed(now, first_start_);
    const bool is_first = until_first.count() > 0 && until_first <= policy_.first_starts;
    const NodeTime from = is_first ? first_start_ : now;
    const auto period = static_cast<std::uint64_t>(trim_.configured().count());
    const auto off = static_cast<std::uint64_t>(trim_.configured().count() + start_off_.count());
    const std::uint64_t phase = (config_.phase_us + off) % period;
    const std::uint64_t into_period = (clock_.us_at(from) + period - phase) % period;
    const std::uint64_t wait = (period - into_period) % period;
    return from + Microseconds{static_cast<std::int64_t>(wait)};
}

Microseconds Ranging::budget() const noexcept {
    return Microseconds{std::int64_t{config_.timing_budget_ms} * 1'000};
}

}  // namespace octoskin::node
