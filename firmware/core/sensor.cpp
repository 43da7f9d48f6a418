#include "firmware/core/sensor.hpp"

#include <algorithm>
#include <utility>

#include "common/range_status.hpp"
#include "firmware/core/time_bracket.hpp"

namespace octoskin::node {

namespace {

using wire::CalibrationOutcome;
using wire::SensorFault;
using wire::SensorState;

// A period shorter than the budget plus this makes the device skip every second start slot (UM2510 3.3; the
// driver also refuses it).
constexpr Microseconds kPeriodMargin{5'000};

SensorState state_after(SensorFault fault, bool has_ever_answered) noexcept {
    switch (fault) {
        case SensorFault::no_answer:
        case SensorFault::bus_error:
        case SensorFault::address_conflict:
        case SensorFault::xshut_stuck:
            return has_ever_answered ? SensorState::lost : SensorState::absent;
        case SensorFault::none:
        case SensorFault::wrong_id:
        case SensorFault::boot_timeout:
        case SensorFault::config_mismatch:
        case SensorFault::no_data_ready:
        case SensorFault::stale_stream:
        case SensorFault::reads_disagree:
        case SensorFault::implausible_block:
        case SensorFault::hardware_fail:
            return SensorState::degraded;
    }
    return SensorState::degraded;
}

}  // namespace

Sensor::Sensor(const SensorConfig& config, const SensorSurroundings& surroundings,
               const vl53l1x::Options& options, const RangingRules& rules, const Policy& policy, NodeTime now)
    : config_(config),
      policy_(policy),
      device_(surroundings.bus, options),
      bring_up_(device_, surroundings.default_address, surroundings.xshut, config_, policy),
      ranging_(device_, config_, rules, policy, surroundings.clock, now),
      recovery_(policy),
      calibration_(device_, Microseconds{std::int64_t{config.inter_measurement_ms} * 1'000}) {
    begin_bring_up(now);
}

void Sensor::order_start(NodeTime now) {
    if (std::exchange(is_ordered_to_range_, true)) return;
    if (mode_ != Mode::stopped) return;
    if (!has_rested_long_) return range_or_rest(now);
    state_ = SensorState::starting;
    rest_due_ = now;
}

void Sensor::order_stop(NodeTime now) {
    is_ordered_to_range_ = false;
    if (mode_ == Mode::ranging) ranging_.request_stop(now);
    if (mode_ == Mode::stopped) state_ = SensorState::stopped;
}

void Sensor::order_reinitialise(NodeTime now) {
    // Both end with a bring-up anyway.
    if (mode_ != Mode::bringing_up && mode_ != Mode::calibrating) reinitialise_ordered_ = now;
}

void Sensor::on_overlooking_more(NodeTime now) {
    device_.forget_overlooked();
    bring_up_.on_overlooking_more();
    if (fault_ != SensorFault::config_mismatch || device_.read_back().is_distrusted()) return;
    recovery_.reset();
    fault_ = SensorFault::none;
    mismatches_in_row_ = 0;
    if (mode_ != Mode::awaiting_recovery) return;
    state_ = SensorState::starting;
    plan_ = {.step = RecoveryStep::xshut_cycle, .at = now};
}

bool Sensor::order_calibration(const CalibrationOrder& order, NodeTime now) {
    // What such a part measures is not usable.
    if (device_.read_back().is_distrusted()) return false;
    if (calibration_ordered_ || !vl53l1x::CalibrationRun::is_target_supported(order.target_mm)) return false;
    order_reinitialise(now);
    calibration_ordered_ = order;
    return true;
}

bool Sensor::order_period(std::optional<Microseconds> period, NodeTime now) {
    const Microseconds configured{std::int64_t{config_.inter_measurement_ms} * 1'000};
    const Microseconds budget{std::int64_t{config_.timing_budget_ms} * 1'000};
    const Microseconds wanted = period.value_or(configured);
    if (wanted < budget + kPeriodMargin) return false;
    ranging_.set_period(wanted, now);
    is_period_overridden_ = wanted != configured;
    return true;
}

std::optional<NodeTime> Sensor::due_otherwise() const noexcept {
    if (is_reinitialisation_due()) return reinitialise_ordered_;
    switch (mode_) {
        case Mode::bringing_up:
            return bring_up_.due();
        case Mode::calibrating:
            return calibration_due_;
        case Mode::ranging:
            return ranging_.due();
        case Mode::awaiting_recovery:
            return plan_.at;
        case Mode::stopped:
            return has_rested_long_ && !is_ordered_to_range_ ? std::nullopt : std::optional(rest_due_);
    }
    return std::nullopt;
}

bool Sensor::is_reinitialisation_due() const noexcept {
    return reinitialise_ordered_ && mode_ != Mode::bringing_up && !device_.is_busy();
}

BusUse Sensor::advance(NodeTime now) {
    if (is_reinitialisation_due()) {
        recovery_.reset();
        if (!calibration_ordered_) ++counts_.restarts;
        state_ = SensorState::starting;
        begin_bring_up(now);
        return BusUse::releases;
    }
    switch (mode_) {
        case Mode::bringing_up:
            return advance_bring_up(now);
        case Mode::calibrating:
            return advance_calibrating(now);
        case Mode::ranging:
            return advance_ranging(now);
        case Mode::awaiting_recovery:
            recover(now);
            return BusUse::releases;
        case Mode::stopped:
            if (is_ordered_to_range_) {
                begin_bring_up(now);
            } else {
                has_rested_long_ = true;
            }
            break;
    }
    return BusUse::releases;
}

void Sensor::begin_bring_up(NodeTime now) {
    reinitialise_ordered_.reset();
    hardware_fails_in_row_ = 0;
    undated_in_row_ = 0;
    ranging_.abandon();
    bring_up_.begin(now);
    mode_ = Mode::bringing_up;
}

BusUse Sensor::advance_bring_up(NodeTime now) {
    const BusUse use = bring_up_.advance(now);
    has_ever_answered_ = has_ever_answered_ || bring_up_.has_answered();
    switch (bring_up_.outcome()) {
        case BringUp::Outcome::under_way:
            break;
        case BringUp::Outcome::done:
            ranging_.on_configured();
            if (calibration_ordered_) {
                begin_calibration(now);
            } else {
                range_or_rest(now);
            }
            break;
        case BringUp::Outcome::failed:
            if (calibration_ordered_) end_calibration({.outcome = CalibrationOutcome::not_brought_up});
            on_failure(bring_up_.fault(), false, now);
            break;
    }
    return use;
}

void Sensor::range_or_rest(NodeTime now) {
    if (is_ordered_to_range_) {
        if (state_ == SensorState::stopped) state_ = SensorState::starting;
        ranging_.begin(now);
        mode_ = Mode::ranging;
    } else {
        state_ = SensorState::stopped;
        is_settled_ = true;
        rest_due_ = now + policy_.rest_max;
        has_rested_long_ = false;
        mode_ = Mode::stopped;
    }
}

void Sensor::begin_calibration(NodeTime now) {
    if (calibration_ordered_->quantity == wire::CalibrationQuantity::offset) {
        calibration_.begin_offset(calibration_ordered_->target_mm);
    } else {
        calibration_.begin_crosstalk(calibration_ordered_->target_mm);
    }
    calibration_due_ = now;
    state_ = SensorState::stopped;
    mode_ = Mode::calibrating;
}

void Sensor::end_calibration(const CalibrationResult& result) {
    calibration_result_ = result;
    calibration_ordered_.reset();
}

BusUse Sensor::advance_calibrating(NodeTime now) {
    const vl53l1x::Progress progress = calibration_.poll(now);
    if (progress == vl53l1x::Progress::busy) {
        const auto wake = calibration_.wake_time();
        if (!wake || is_reached(*wake, now)) return BusUse::keeps;
        calibration_due_ = *wake;
        return BusUse::releases;
    }
    end_calibration(result_of(calibration_, progress));
    state_ = SensorState::starting;
    begin_bring_up(now);
    return BusUse::releases;
}

BusUse Sensor::advance_ranging(NodeTime now) {
    const bool are_readings_withheld = device_.read_back().is_distrusted();
    const Ranging::Result result = ranging_.advance(now);
    switch (result.event) {
        case Ranging::Event::none:
            break;
        case Ranging::Event::reading:
            if (are_readings_withheld) {
                on_withheld();
                break;
            }
            reading_ = ranging_.reading();
            if (device_.read_back().exempt_count() > 0) ++counts_.suspect;
            on_result(now);
            break;
        case Ranging::Event::undated:
            if (are_readings_withheld) {
                on_withheld();
                break;
            }
            on_undated(now);
            break;
        case Ranging::Event::refused:
            on_refused();
            break;
        case Ranging::Event::stopped:
            range_or_rest(now);
            break;
        case Ranging::Event::failed:
            if (!are_readings_withheld) counts_.suspect += ranging_.suspect_readings();
            on_failure(ranging_.fault(), ranging_.can_restart(), now);
            break;
    }
    return mode_ == Mode::ranging ? result.bus : BusUse::releases;
}

/// A range that the part itself reports as failed is sent, with its status, and proves nothing. A single one
/// may be an accident; this many in a row mean a part that needs a new start, or a new part.
void Sensor::on_result(NodeTime now) {
    if (range_status(ranging_.reading().device_status).status != RangeStatus::hardware_fail) {
        hardware_fails_in_row_ = 0;
        on_reading();
        return;
    }
    is_settled_ = true;
    refused_in_row_ = 0;
    if (++hardware_fails_in_row_ >= policy_.hardware_fails_until_failure)
        give_up_ranging(SensorFault::hardware_fail, now);
}

void Sensor::on_reading() {
    is_settled_ = true;
    undated_in_row_ = 0;
    if (ranging_.is_proven()) {
        refused_in_row_ = 0;
        recovery_.on_proven_reading();
    }
    if (ranging_.is_proven() && !recovery_.is_under_way()) mismatches_in_row_ = 0;
    // A frozen sensor gives one first result after each restart: only the second proves that it measures.
    if (ranging_.is_proven() || state_ == SensorState::starting) state_ = SensorState::ranging;
}

/// It ranges at unknown times. After a slip this is normal for a while; for longer, the ready pin or the
/// rhythm of the sensor cannot be followed.
void Sensor::on_undated(NodeTime now) {
    is_settled_ = true;
    ++counts_.rejected;
    ++counts_.undated;
    if (++undated_in_row_ >= policy_.undated_until_failure) give_up_ranging(SensorFault::stale_stream, now);
}

/// It answers, but the answers are of no use: only a new bring-up may help.
void Sensor::give_up_ranging(SensorFault fault, NodeTime now) {
    device_.abandon();
    ranging_.abandon();
    on_failure(fault, false, now);
}

void Sensor::on_refused() {
    fault_ = ranging_.fault();
    ++counts_.rejected;
    if (fault_ == SensorFault::reads_disagree) ++counts_.reads_disagreed;
    if (refused_in_row_ < policy_.rejections_until_degraded) ++refused_in_row_;
    if (refused_in_row_ == policy_.rejections_until_degraded) state_ = SensorState::degraded;
}

/// It ranges, but looks elsewhere or measures another distance than configured. So its ranging proves
/// nothing: after the next failure it is left alone for longer.
void Sensor::on_withheld() {
    is_settled_ = true;
    fault_ = SensorFault::config_mismatch;
    state_ = SensorState::degraded;
    ++counts_.rejected;
    ++counts_.withheld;
}

void Sensor::on_failure(wire::SensorFault fault, bool can_restart, NodeTime now) {
    fault_ = fault;
    state_ = state_after(fault, has_ever_answered_);
    is_settled_ = true;
    is_bus_suspect_ = fault == SensorFault::bus_error;
    ++counts_.restarts;
    const bool is_mismatch = fault == SensorFault::config_mismatch;
    const int mismatches = is_mismatch ? mismatches_in_row_ + 1 : 0;
    mismatches_in_row_ = static_cast<std::uint8_t>(std::min(mismatches, 255));
    if (!recovery_.is_under_way()) has_failed_ = true;
    plan_ = recovery_.on_failure(can_restart, now);
    // A sensor that may be at the default address unexpectedly waits in reset.
    if (plan_.step == RecoveryStep::xshut_cycle) bring_up_.hold_in_reset();
    mode_ = Mode::awaiting_recovery;
}

void Sensor::isolate(NodeTime now) {
    device_.abandon();
    ranging_.abandon();
    calibration_.abandon();
    // Hours may pass, and the target may be gone.
    if (calibration_ordered_) end_calibration({.outcome = CalibrationOutcome::device_failed});
    if (mode_ != Mode::awaiting_recovery) {
        on_failure(SensorFault::bus_error, false, now);
        is_bus_suspect_ = false;  // it is already known
    }
    fault_ = SensorFault::bus_error;
    state_ = state_after(fault_, has_ever_answered_);
    plan_.step = RecoveryStep::xshut_cycle;
    bring_up_.hold_in_reset();
    // What became due meanwhile stays due: half an hour later its time would lie in the future.
    plan_.at = later_of(plan_.at, now);
    if (reinitialise_ordered_) reinitialise_ordered_ = now;
}

void Sensor::recover(NodeTime now) {
    if (plan_.step == RecoveryStep::xshut_cycle) {
        begin_bring_up(now);
        return;
    }
    ranging_.begin_restart(now);
    // A stop may have been ordered during the read that failed, or since.
    if (!is_ordered_to_range_) ranging_.request_stop(now);
    mode_ = Mode::ranging;
}

bool Sensor::is_degraded() const noexcept {
    if (!is_ordered_to_range_ || !is_settled_) return false;
    if (calibration_ordered_) return false;
    const vl53l1x::ReadBack& read_back = device_.read_back();
    if (read_back.exempt_count() > 0 || read_back.is_distrusted()) return true;
    return state_ != SensorState::ranging && state_ != SensorState::stopped &&
           state_ != SensorState::starting;
}

std::optional<vl53l1x::RegisterDifference> Sensor::register_to_report() const noexcept {
    const vl53l1x::ReadBack& read_back = device_.read_back();
    if (const auto fixed = read_back.fixed_register()) return fixed;
    if (mismatches_in_row_ >= vl53l1x::ReadBack::kSightingsUntilFixed) return read_back.last_difference();
    return std::nullopt;
}

std::optional<CalibrationResult> Sensor::take_calibration() noexcept {
    return std::exchange(calibration_result_, std::nullopt);
}

bool Sensor::take_bus_suspicion() noexcept {
    return std::exchange(is_bus_suspect_, false);
}

}  // namespace octoskin::node
