#include "host/core/ingest/range_gate.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "common/range_status.hpp"

namespace octoskin {
namespace {

/// The field of a classical frame saturates at 127 mm and then means "at least". It is read as the largest
/// value that a device can report, so that a limit means the same on both kinds of bus.
double sigma_m_of(const wire::RangeReading& reading) {
    constexpr std::uint16_t kClassicalEnd = 127 * 4;
    constexpr std::uint16_t kLargest = 0xFFFF;
    const bool is_classical = reading.capture.span_us == wire::kClassicalTimeSpanUs;
    const bool is_saturated = is_classical && reading.sigma_quarter_mm >= kClassicalEnd;
    return 0.25e-3 * (is_saturated ? kLargest : reading.sigma_quarter_mm);
}

/// A reading waits at most 50 ms on its node; the rest is transport and host.
constexpr Nanoseconds kTransportMax{100'000'000};

ReadingReason reason_of(SequenceFault fault) {
    switch (fault) {
        case SequenceFault::duplicate:
            return ReadingReason::duplicate;
        case SequenceFault::out_of_window:
            return ReadingReason::out_of_window;
        case SequenceFault::too_soon:
            return ReadingReason::too_soon;
        case SequenceFault::behind:
            return ReadingReason::contradicts_reading;
    }
    return ReadingReason::out_of_window;
}

/// By the newest report of its node. A node sends no readings of such a sensor. Readings that arrive all the
/// same, or before the report that the sensor is well again, are refused.
bool is_misconfigured(const SensorRecord& record) {
    return record.health && record.health->state == wire::SensorState::degraded &&
           record.health->fault == wire::SensorFault::config_mismatch;
}

/// Why its age makes the capture time impossible; empty: it is possible. The host time may be `now_early`
/// behind.
std::optional<ReadingReason> age_fault(Nanoseconds age, Nanoseconds half_window, Nanoseconds now_early) {
    if (age < half_window - now_early) {
        return ReadingReason::too_young;
    }
    if (age > half_window + kTransportMax) {
        return ReadingReason::too_old;
    }
    return std::nullopt;
}

}  // namespace

RangeGate::Sensor::Sensor(const HostSensor& sensor)
    : expected(sensor), cadence(Nanoseconds{sensor.period}), senders(Nanoseconds{sensor.period}) {}

RangeGate::RangeGate(const HostRig& rig, bool uses_no_return, Nanoseconds now_early)
    : limits_(rig.range_limits), uses_no_return_(uses_no_return), now_early_(now_early) {
    for (const HostNode& node : rig.nodes) {
        for (std::size_t i = 0; i < node.sensors.size(); ++i) {
            sensors_.emplace(SensorId{node.node_id, static_cast<std::uint8_t>(i)}, Sensor(node.sensors[i]));
        }
    }
}

void RangeGate::on_arrival(wire::NodeId node, const wire::RangeReading& reading,
                           std::optional<HostTime> now) {
    Sensor& sensor = sensors_.at({node, reading.sensor});
    SensorRecord& record = sensor.record;
    ++record.received;
    record.sent.on_arrival();
    record.newest = reading;
    record.arrivals.note(now, SensorRecord::break_after(Nanoseconds{sensor.expected.period}));
    record.note_word(now);
}

void RangeGate::on_fate(wire::NodeId node, std::uint8_t sensor, std::optional<ReadingReason> rejected) {
    SensorRecord& record = sensors_.at({node, sensor}).record;
    record.newest_rejected = rejected;
    if (rejected) {  // the result of an accepted reading comes from the map
        record.fates.note(rejected);
    }
}

void RangeGate::on_fate_in_map(wire::NodeId node, std::uint8_t sensor,
                               std::optional<ReadingReason> rejected) {
    SensorRecord& record = sensors_.at({node, sensor}).record;
    record.newest_rejected = rejected ? rejected : record.newest_rejected;
    record.fates.note(rejected);
}

bool RangeGate::is_certain(const Sensor& sensor, const MappedTime& captured) const {
    const auto& reported = sensor.record.capture_bound;
    return reported && captured.error_bound + *reported <= limits_.time_uncertainty_max;
}

/// Ranging windows of one sensor do not overlap. The sensor's oscillator may be 7 % fast, and each time has
/// an error: three quarters of the nominal window leave room for both. A sensor that keeps its period is
/// never twice as fast: a second sender's readings do not fit between those of a slow sensor.
Nanoseconds RangeGate::spacing_min(const Sensor& sensor, wire::NodeId node, HostTime now) const {
    const auto since = rate_overridden_since_.find(node);
    const bool is_as_configured =
        since == rate_overridden_since_.end() || now - since->second < kOverriddenFor;
    const Nanoseconds window = Nanoseconds{sensor.expected.timing_budget} * 3 / 4;
    return is_as_configured ? std::max(window, Nanoseconds{sensor.expected.period} / 2) : window;
}

void RangeGate::on_rate(wire::NodeId node, bool is_overridden, std::optional<HostTime> now) {
    if (!is_overridden) {
        rate_overridden_since_.erase(node);
    } else if (now) {
        rate_overridden_since_.try_emplace(node, *now);
    }
}

void RangeGate::on_contradiction(Sensor& sensor, wire::NodeId node, HostTime now) {
    sensor.senders.on_contradiction(now);
    contradicted_[node] = now;
}

/// Checks whether the reading's number was received before, independent of its time.
std::optional<ReadingReason> RangeGate::number_fault(Sensor& sensor, wire::NodeId node,
                                                     const wire::RangeReading& reading, HostTime now) {
    // delay of one frame relative to another: transport, or a stalled bus
    constexpr Nanoseconds kDelayMax{250'000'000};
    const Nanoseconds turn_min = spacing_min(sensor, node, now) * wire::kSequenceCount - kDelayMax;
    switch (sensor.said.compare(reading, now, turn_min)) {
        case SaidNumbers::Fate::is_new:
            return std::nullopt;
        case SaidNumbers::Fate::same:
            --sensor.record.received;
            return ReadingReason::duplicate;
        case SaidNumbers::Fate::other:
            --sensor.record.received;
            on_contradiction(sensor, node, now);
            return ReadingReason::contradicts_reading;
    }
    return std::nullopt;
}

/// A reading of known time takes its number only if the time is possible: otherwise the true reading of that
/// number may still arrive.
std::optional<ReadingReason> RangeGate::place_fault(Sensor& sensor, const Arrival& arrival) {
    const Nanoseconds half_window = Nanoseconds{sensor.expected.timing_budget} / 2;
    if (const auto fault = age_fault(arrival.now - arrival.captured, half_window, now_early_)) {
        if (*fault == ReadingReason::too_young) sensor.senders.on_refused();
        return fault;
    }
    const std::uint8_t sequence = arrival.reading.sequence;
    const Nanoseconds spacing = spacing_min(sensor, arrival.node, arrival.now);
    const auto place = sensor.record.sequence.place(sequence, arrival.captured, spacing);
    if (!place) {
        note_misplaced(sensor, arrival, place.error());
        return reason_of(place.error());
    }
    if (arrival.is_clock_questioned && !sensor.cadence.fits(sequence, arrival.captured)) {
        sensor.record.sequence.skip();
        return ReadingReason::clock_in_doubt;
    }
    sensor.record.sequence.take(sequence, arrival.captured, *place);
    sensor.said.take(arrival.reading, arrival.now);
    if (place->is_newest) {
        const auto left_out = place->is_counted ? std::optional(place->left_out) : std::nullopt;
        sensor.cadence.on_accepted(sequence, arrival.captured);
        sensor.senders.on_taken(left_out, arrival.now);
    }
    return std::nullopt;
}

void RangeGate::note_misplaced(Sensor& sensor, const Arrival& arrival, SequenceFault fault) {
    if (fault == SequenceFault::duplicate) {
        --sensor.record.received;
    } else if (fault == SequenceFault::behind) {
        on_contradiction(sensor, arrival.node, arrival.now);
    } else {
        sensor.senders.on_refused();
    }
}

std::optional<ReadingReason> RangeGate::skip(wire::NodeId node, const wire::RangeReading& reading,
                                             std::optional<HostTime> now) {
    Sensor& sensor = sensors_.at({node, reading.sensor});
    if (now) {
        if (const auto fault = number_fault(sensor, node, reading, *now)) return fault;
        sensor.said.take(reading, *now);
    }
    sensor.record.sequence.skip();
    return std::nullopt;
}

std::optional<ReadingReason> RangeGate::figure_fault(double range_m, double sigma_m) const {
    if (!std::isfinite(range_m) || !std::isfinite(sigma_m)) {
        return ReadingReason::not_finite;
    }
    if (range_m < limits_.min_m) {
        return ReadingReason::below_range_min;
    }
    if (range_m > limits_.max_m) {
        return ReadingReason::above_range_max;
    }
    if (sigma_m > limits_.sigma_max_m) {
        return ReadingReason::sigma_above_max;
    }
    return std::nullopt;
}

Result<RangeMeasurement, ReadingReason> RangeGate::check(wire::NodeId node, const wire::RangeReading& reading,
                                                         const MappedTime& captured, HostTime now,
                                                         bool is_clock_questioned) {
    Sensor& sensor = sensors_.at({node, reading.sensor});
    if (!is_certain(sensor, captured)) {  // such a time does not determine the order of readings
        return unexpected(skip(node, reading, now).value_or(ReadingReason::time_uncertain));
    }
    if (const auto fault = number_fault(sensor, node, reading, now)) {
        return unexpected(*fault);
    }
    if (const auto fault = place_fault(sensor, {node, reading, captured.time, now, is_clock_questioned})) {
        return unexpected(*fault);
    }
    ++sensor.record.device_status[reading.device_status];
    if (sensor.senders.is_disputed(now)) {
        return unexpected(ReadingReason::sensor_disputed);
    }
    if (is_misconfigured(sensor.record)) {
        return unexpected(ReadingReason::sensor_misconfigured);
    }
    const RangeUse use = range_status(reading.device_status).use;
    if (use == RangeUse::nothing) {
        return unexpected(ReadingReason::status_fault);
    }
    if (use == RangeUse::no_return && !uses_no_return_) {
        return unexpected(ReadingReason::no_return);
    }
    if (reading.zone == wire::kZoneUnknown) {
        return unexpected(ReadingReason::zone_unknown);
    }
    if (reading.zone >= sensor.expected.zones.size()) {
        return unexpected(ReadingReason::zone_not_in_rig);
    }
    RangeMeasurement measurement{.source = {node, reading.sensor, reading.zone},
                                 .captured = captured.time,
                                 .range_m = std::nullopt,
                                 .sigma_m = sigma_m_of(reading)};
    if (use == RangeUse::hit) {
        const double range_m = 1e-3 * reading.range_mm + sensor.expected.zones[reading.zone].offset_m;
        if (const auto fault = figure_fault(range_m, measurement.sigma_m)) {
            return unexpected(*fault);
        }
        measurement.range_m = range_m;
    }
    return measurement;
}

/// The reading of the same number arrives within the age limit if both have the same time. Otherwise it
/// arrives at most half a period later, plus 60 ms for the node and the bus.
std::optional<HostTime> RangeGate::held_until(const RangeMeasurement& measurement, HostTime now) const {
    // the longest period that docs/reference/reliability.md covers
    constexpr Nanoseconds kPeriodMax{250'000'000};
    constexpr Nanoseconds kOnItsWay{60'000'000};
    const auto contradicted = contradicted_.find(measurement.source.node_id);
    if (contradicted == contradicted_.end() || std::chrono::abs(now - contradicted->second) >= kSuspicion) {
        return std::nullopt;
    }
    const HostSensor& sensor = sensors_.at(measurement.source.sensor_id()).expected;
    const Nanoseconds half_period = std::min(Nanoseconds{sensor.period}, kPeriodMax) / 2;
    const Nanoseconds wait =
        Nanoseconds{sensor.timing_budget} / 2 + std::max(kTransportMax, half_period + kOnItsWay);
    return measurement.captured + std::min(wait, kHeldMax);
}

void RangeGate::on_health(wire::NodeId node, const wire::SensorHealth& health, std::optional<HostTime> now) {
    SensorRecord& record = sensors_.at({node, health.sensor}).record;
    record.note_word(now);
    record.sent.on_health(health.sent, record.received, now);
    record.health = health;
    record.capture_bound = Microseconds{wire::kClassicalTimeStepUs} * health.capture_bound_64us;
}

void RangeGate::on_signal(wire::NodeId node, std::uint8_t sensor, const wire::SignalReading& signal) {
    sensors_.at({node, sensor}).record.signal = signal;
}

void RangeGate::on_reflex(wire::NodeId node, const wire::Reflex& reflex) {
    SensorRecord& record = sensors_.at({node, reflex.sensor}).record;
    ++record.reflexes;
    record.reflex = reflex;
}

void RangeGate::on_damage(wire::NodeId node, HostTime now) {
    for_each_of(node, [&](Sensor& sensor) { sensor.senders.on_damage(now); });
}

void RangeGate::expect(wire::NodeId node, std::optional<HostTime> now) {
    for_each_of(node, [&](Sensor& sensor) {
        sensor.record.words = {};
        sensor.record.note_word(now);
    });
}

void RangeGate::forget(wire::NodeId node) {
    forget_order(node);
    for_each_of(node, [&](Sensor& sensor) {
        sensor.record.sent.restart();
        sensor.record.health.reset();
        sensor.record.capture_bound.reset();
    });
}

void RangeGate::forget_order(wire::NodeId node) {
    for_each_of(node, [&](Sensor& sensor) {
        sensor.record.sequence.restart();
        sensor.said.restart();
        sensor.cadence.restart();
        sensor.senders.forget_refused();
    });
}

void RangeGate::on_clock_confirmed(wire::NodeId node) {
    for_each_of(node, [&](Sensor& sensor) { sensor.cadence.confirm(); });
}

void RangeGate::on_clock_contradicted(wire::NodeId node) {
    for_each_of(node, [&](Sensor& sensor) { sensor.senders.forget_refused(); });
}

}  // namespace octoskin
