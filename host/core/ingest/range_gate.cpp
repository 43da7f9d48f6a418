#include "host/core/ingest/range_gate.hpp"

#include <cmath>

#include "common/range_status.hpp"

namespace octoskin {
namespace {

/// The classical frame's field ends at 127 mm and then only says "at least": taken as the largest that a
/// device can tell, so that a limit means the same on both kinds of bus.
double sigma_m_of(const wire::RangeReading& reading) {
    constexpr std::uint16_t kClassicalEnd = 127 * 4;
    constexpr std::uint16_t kLargest = 0xFFFF;
    const bool is_classical = reading.capture.span_us == wire::kClassicalTimeSpanUs;
    const bool is_saturated = is_classical && reading.sigma_quarter_mm >= kClassicalEnd;
    return 0.25e-3 * (is_saturated ? kLargest : reading.sigma_quarter_mm);
}

/// A reading waits 50 ms at most on its node; the rest is bus and host.
constexpr Nanoseconds kTransportMax{100'000'000};
/// "Now" may be this much behind (HostClockConfig::back_tolerance).
constexpr Nanoseconds kNowEarlyMax{5'000'000};

ReadingReason reason_of(SequenceFault fault) {
    switch (fault) {
        case SequenceFault::duplicate:
            return ReadingReason::duplicate;
        case SequenceFault::out_of_window:
            return ReadingReason::out_of_window;
        case SequenceFault::too_soon:
            return ReadingReason::too_soon;
    }
    return ReadingReason::out_of_window;
}

/// By its node's last word. A node sends no readings of such a sensor; one that does, or one that comes
/// before the word that all is well again, has no right to the map.
bool is_misconfigured(const SensorRecord& record) {
    return record.health && record.health->state == wire::SensorState::degraded &&
           record.health->fault == wire::SensorFault::config_mismatch;
}

}  // namespace

RangeGate::RangeGate(const HostRig& rig, bool uses_no_return)
    : limits_(rig.range_limits), uses_no_return_(uses_no_return) {
    for (const HostNode& node : rig.nodes) {
        for (std::size_t i = 0; i < node.sensors.size(); ++i) {
            sensors_[{node.node_id, static_cast<std::uint8_t>(i)}].expected = node.sensors[i];
        }
    }
}

void RangeGate::on_arrival(wire::NodeId node, const wire::RangeReading& reading,
                           std::optional<HostTime> now) {
    SensorRecord& record = sensors_.at({node, reading.sensor}).record;
    ++record.received;
    record.newest = reading;
    record.newest_at = now;
}

void RangeGate::on_fate(wire::NodeId node, std::uint8_t sensor, std::optional<ReadingReason> rejected) {
    SensorRecord& record = sensors_.at({node, sensor}).record;
    record.newest_rejected = rejected;
    if (rejected) {  // of the others the map has the last word
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
    const auto& told = sensor.record.capture_bound;
    return told && captured.error_bound + *told <= limits_.time_uncertainty_max;
}

std::optional<ReadingReason> RangeGate::place_fault(Sensor& sensor, const wire::RangeReading& reading,
                                                    HostTime captured, HostTime now) const {
    // Ranging windows of one sensor do not overlap. The sensor's oscillator may be 7 % fast, and each time
    // carries an error: three quarters of the nominal window leave room for both.
    const Nanoseconds spacing_min = Nanoseconds{sensor.expected.timing_budget} * 3 / 4;
    const auto place = sensor.record.sequence.observe(reading.sequence, captured, spacing_min);
    if (!place) {
        sensor.record.received -= place.error() == SequenceFault::duplicate ? 1U : 0U;
        return reason_of(place.error());
    }
    const Nanoseconds half_window = Nanoseconds{sensor.expected.timing_budget} / 2;
    if (now - captured < half_window - kNowEarlyMax) {
        return ReadingReason::too_young;
    }
    if (now - captured > half_window + kTransportMax) {
        return ReadingReason::too_old;
    }
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
                                                         const MappedTime& captured, HostTime now) {
    Sensor& sensor = sensors_.at({node, reading.sensor});
    if (!is_certain(sensor, captured)) {
        sensor.record.sequence.skip();  // such a time is no evidence of what came before what
        return unexpected(ReadingReason::time_uncertain);
    }
    if (const auto fault = place_fault(sensor, reading, captured.time, now)) {
        return unexpected(*fault);
    }
    ++sensor.record.device_status[reading.device_status];
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

void RangeGate::on_health(wire::NodeId node, const wire::SensorHealth& health) {
    SensorRecord& record = sensors_.at({node, health.sensor}).record;
    if (!record.health) {
        record.received_before = record.received;
        record.sent_total = 0;
    } else {
        record.sent_total += static_cast<std::uint16_t>(health.sent - record.health->sent);
    }
    record.health = health;
    record.capture_bound = Microseconds{wire::kClassicalTimeStepUs} * health.capture_bound_64us;
    const std::uint64_t received = record.received - record.received_before;
    record.lost = record.lost_before + (record.sent_total > received ? record.sent_total - received : 0);
}

void RangeGate::on_signal(wire::NodeId node, std::uint8_t sensor, const wire::SignalReading& signal) {
    sensors_.at({node, sensor}).record.signal = signal;
}

void RangeGate::on_reflex(wire::NodeId node, const wire::Reflex& reflex) {
    SensorRecord& record = sensors_.at({node, reflex.sensor}).record;
    ++record.reflexes;
    record.reflex = reflex;
}

void RangeGate::forget(wire::NodeId node) {
    forget_order(node);
    for (auto& [key, sensor] : sensors_) {
        if (key.first == node) {
            sensor.record.lost_before = sensor.record.lost;
            sensor.record.health.reset();
            sensor.record.capture_bound.reset();
        }
    }
}

void RangeGate::forget_order(wire::NodeId node) {
    for (auto& [key, sensor] : sensors_) {
        if (key.first == node) {
            sensor.record.sequence.restart();
        }
    }
}

}  // namespace octoskin
