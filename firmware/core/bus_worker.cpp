#include "firmware/core/bus_worker.hpp"

#include <algorithm>
#include <cassert>
#include <span>
#include <utility>

#include "firmware/drivers/i2c/transfer_time.hpp"

namespace octoskin::node {

namespace {

// A step takes a few microseconds on the board; two transitions without a transfer may follow each other.
constexpr int kStepsPerPoll = 4;

// A result block, the longest use of the bus by a ranging sensor, plus 10 % for a bus that runs slower than
// configured.
constexpr std::int64_t kLongestReadBits = std::int64_t{i2c::bit_count(2, 17)} * 11 / 10;
// A poll, plus 50 %.
constexpr std::int64_t kLongestPollBits = std::int64_t{i2c::bit_count(2, 1)} * 3 / 2;

}  // namespace

BusWorker::BusWorker(i2c::Bus& bus, std::uint32_t i2c_hz, const vl53l1x::Options& options,
                     const Policy& policy, const DataReadyHint& hint)
    : bus_(bus),
      default_address_(shared_bus_, options),
      hint_(hint),
      policy_(policy),
      longest_read_(kLongestReadBits * 1'000'000 / i2c_hz),
      longest_poll_(kLongestPollBits * 1'000'000 / i2c_hz) {}

void BusWorker::add(Sensor& sensor) {
    assert(sensor_count_ < sensors_.size());
    sensors_[sensor_count_++] = &sensor;
    default_address_.reserve(sensor.address());
}

void BusWorker::poll(NodeTime now) {
    if (!has_sensors()) return;
    // The controller may have been reset in the middle of a sensor's byte: the bus is freed before first use.
    const bool is_retry_due = is_faulty_ && is_reached(retry_at_, now);
    if (!std::exchange(has_started_, true) || is_retry_due) free_bus(now);

    follow_hint(now);
    for (int step = 0; step < kStepsPerPoll && !is_faulty_; ++step) {
        if (owner_ == nullptr) take_turns(now);
        if (owner_ == nullptr) return;
        advance_owner(now);
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

/// Chooses the next owner of the free bus: first a sensor that must be punctual, then one that was
/// interrupted, then the one that has been due longest. A sensor that has waited too long goes before all but
/// a start.
void BusWorker::take_turns(NodeTime now) {
    awaited_ = nullptr;
    Sensor* const punctual = first_punctual(now + longest_read_);
    const bool is_for_start = punctual != nullptr && punctual->awaits_start();
    const auto waits_long = [&](NodeTime since) {
        return !is_for_start && is_reached(since + policy_.bus_wait_max, now);
    };
    if (interrupted_count_ > 0 && (punctual == nullptr || waits_long(interrupted_at_))) {
        begin_turn(longest_interrupted(), !waits_long(interrupted_at_));
        interrupted_at_ = now;
        return;
    }
    Sensor* const longest = longest_due(now, punctual != nullptr);
    if (longest != nullptr && (punctual == nullptr || waits_long(*longest->due()))) {
        begin_turn(longest, true);
    } else if (punctual != nullptr && is_reached(*punctual->deadline_due(), now)) {
        begin_turn(punctual, true);
    } else {
        awaited_ = punctual;
    }
}

void BusWorker::begin_turn(Sensor* sensor, bool is_preemptible) noexcept {
    owner_ = sensor;
    is_owner_under_way_ = false;
    is_preemptible_ = is_preemptible;
}

bool BusWorker::is_interrupted(const Sensor* sensor) const noexcept {
    const auto interrupted = std::span(interrupted_).first(interrupted_count_);
    return std::ranges::find(interrupted, sensor) != interrupted.end();
}

Sensor* BusWorker::longest_interrupted() noexcept {
    Sensor* const longest = interrupted_.front();
    std::shift_left(interrupted_.begin(), interrupted_.begin() + interrupted_count_, 1);
    --interrupted_count_;
    return longest;
}

/// The owner ends its transfer and begins the next, unless another sensor must be punctual.
void BusWorker::advance_owner(NodeTime now) {
    Sensor& sensor = *owner_;
    const bool is_held = is_owner_under_way_ && is_preemptible_ && sensor.is_preemptible() &&
                         first_punctual(now + longest_read_) != nullptr;
    is_owner_under_way_ = true;
    shared_bus_.hold(is_held);
    const BusUse use = sensor.advance(now);
    shared_bus_.hold(false);
    if (use == BusUse::releases) {
        owner_ = nullptr;
    } else if (is_held && !bus_.is_busy()) {
        // Each sensor at most once: an interrupted one is not due to be punctual.
        assert(interrupted_count_ < interrupted_.size());
        if (interrupted_count_ == 0) interrupted_at_ = now;
        interrupted_[interrupted_count_++] = owner_;
        owner_ = nullptr;
    }
    if (sensor.take_confirmation()) hint_.confirm();
    if (sensor.take_bus_suspicion()) free_bus(now);
}

/// Among the sensors, without the owner, that need the bus for themselves at a time not after `by`: the one
/// that needs it first. A start determines the times of all ranges of its run. It goes before polls that
/// become due so shortly before it that they would delay it.
Sensor* BusWorker::first_punctual(NodeTime by) const {
    Sensor* first = nullptr;
    for (Sensor* sensor : std::span(sensors_).first(sensor_count_)) {
        const auto due = sensor->deadline_due();
        if (!due || sensor == owner_) continue;
        const NodeTime needed = sensor->awaits_start() ? *due - longest_poll_ : *due;
        if (!is_reached(needed, by)) continue;
        first = sensor;
        by = needed;
    }
    return first;
}

Sensor* BusWorker::longest_due(NodeTime now, bool is_any_due) const {
    Sensor* longest = nullptr;
    NodeTime longest_since = now;
    for (Sensor* sensor : std::span(sensors_).first(sensor_count_)) {
        const auto due = sensor->due();
        if (!due || !is_reached(*due, now) || is_interrupted(sensor)) continue;
        if (longest != nullptr && is_reached(longest_since, *due)) continue;
        if (is_any_due && sensor->is_deferrable(now)) continue;
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
    // A device holds a line. With all sensors in reset the line is free, unless the fault is elsewhere. The
    // sensors then come back one after the other; the faulty one is the one whose bring-up fails.
    retry_at_ = now + (is_faulty_ ? policy_.bus_retry : policy_.bus_isolation);
    is_faulty_ = true;
    owner_ = nullptr;
    awaited_ = nullptr;
    interrupted_count_ = 0;
    default_address_.watcher().abandon();
    for (Sensor* sensor : std::span(sensors_).first(sensor_count_)) sensor->isolate(now);
}

std::optional<NodeTime> BusWorker::wake_time() const {
    if (is_faulty_) return retry_at_;
    if (bus_.is_busy()) return std::nullopt;
    if (awaited_ != nullptr) return awaited_->deadline_due();
    std::optional<NodeTime> earliest;
    for (const Sensor* sensor : std::span(sensors_).first(sensor_count_)) {
        const auto due = sensor->due();
        if (due && (!earliest || is_reached(*due, *earliest))) earliest = due;
    }
    return earliest;
}

}  // namespace octoskin::node
