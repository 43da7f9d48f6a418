#include "firmware/core/bus_worker.hpp"

#include <cassert>
#include <span>
#include <utility>

namespace octoskin::node {

namespace {

// A step takes a few microseconds on the board; two transitions without a transfer may follow each other.
constexpr int kStepsPerPoll = 4;

}  // namespace

BusWorker::BusWorker(i2c::Bus& bus, const vl53l1x::Options& options, const Policy& policy,
                     const DataReadyHint& hint)
    : bus_(bus), default_address_(bus, options), hint_(hint), policy_(policy) {}

void BusWorker::add(Sensor& sensor) {
    assert(sensor_count_ < sensors_.size());
    sensors_[sensor_count_++] = &sensor;
    default_address_.reserve(sensor.address());
}

void BusWorker::poll(NodeTime now) {
    if (!has_sensors()) return;
    // A controller may have been reset in the middle of a sensor's byte: the bus is freed before first use.
    const bool is_retry_due = is_faulty_ && is_reached(retry_at_, now);
    if (!std::exchange(has_started_, true) || is_retry_due) free_bus(now);

    follow_hint(now);
    for (int step = 0; step < kStepsPerPoll && !is_faulty_; ++step) {
        if (owner_ == nullptr) owner_ = longest_due(now);
        if (owner_ == nullptr) return;
        Sensor& sensor = *owner_;
        if (sensor.advance(now) == BusUse::releases) owner_ = nullptr;
        if (sensor.take_confirmation()) hint_.confirm();
        if (sensor.take_bus_suspicion()) free_bus(now);
        if (bus_.is_busy()) return;
    }
}

void BusWorker::follow_hint(NodeTime now) {
    if (!hint_.take(now)) return;
    for (Sensor* sensor : std::span(sensors_).first(sensor_count_)) {
        sensor->on_hint(now);
        if (sensor->ranges_unasked()) hint_.excuse();
    }
}

Sensor* BusWorker::longest_due(NodeTime now) const {
    Sensor* longest = nullptr;
    NodeTime longest_since = now;
    for (Sensor* sensor : std::span(sensors_).first(sensor_count_)) {
        const auto due = sensor->due();
        if (!due || !is_reached(*due, now)) continue;
        if (longest != nullptr && is_reached(longest_since, *due)) continue;
        longest = sensor;
        longest_since = *due;
    }
    return longest;
}

void BusWorker::free_bus(NodeTime now) {
    if (bus_.recover()) {
        is_faulty_ = false;
        return;
    }
    // Somebody holds a line: with all sensors in reset it is free, unless the fault is elsewhere. They then
    // come back one after the other, and the culprit is the one whose bring-up fails.
    retry_at_ = now + (is_faulty_ ? policy_.bus_retry : policy_.bus_isolation);
    is_faulty_ = true;
    owner_ = nullptr;
    default_address_.watcher().abandon();
    for (Sensor* sensor : std::span(sensors_).first(sensor_count_)) sensor->isolate(now);
}

std::optional<NodeTime> BusWorker::wake_time() const {
    if (is_faulty_) return retry_at_;
    if (bus_.is_busy()) return std::nullopt;
    std::optional<NodeTime> earliest;
    for (const Sensor* sensor : std::span(sensors_).first(sensor_count_)) {
        const auto due = sensor->due();
        if (due && (!earliest || is_reached(*due, *earliest))) earliest = due;
    }
    return earliest;
}

}  // namespace octoskin::node
