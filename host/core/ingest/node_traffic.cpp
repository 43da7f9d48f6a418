#include "host/core/ingest/node_traffic.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "common/wire/bus_load.hpp"

namespace octoskin {
namespace {

std::uint32_t readings_per_s(const HostSensor& sensor) {
    constexpr std::int64_t kSecondUs = 1'000'000;
    const std::int64_t period_us = std::max<std::int64_t>(sensor.period.count(), 1);
    return static_cast<std::uint32_t>((kSecondUs + period_us - 1) / period_us);
}

std::uint32_t readings_per_s(const HostNode& node) {
    std::uint32_t readings = 0;
    for (const HostSensor& sensor : node.sensors) readings += readings_per_s(sensor);
    return readings;
}

/// Frames per second of a node by the rig. Each reading counts as one frame, even if several share one.
std::size_t frames_per_s(const HostNode& node, double joint_rate_hz) {
    const std::uint32_t readings = readings_per_s(node);
    const auto sensors = static_cast<std::uint32_t>(node.sensors.size());
    const wire::BusUse use = {
        .nodes = 1,
        .sensors = sensors,
        .readings_per_s = static_cast<double>(readings),
        .aux_per_s = node.aux_every > 0 ? static_cast<double>(readings / node.aux_every + sensors) : 0.0,
        .joint_samples_per_s = joint_rate_hz};
    double frames = 0.0;
    for (const wire::Traffic& traffic : wire::traffic_of(use)) {
        const bool is_of_node = wire::frame_spec(traffic.type)->party == wire::Party::from_node;
        frames += is_of_node ? traffic.frames_per_s : 0.0;
    }
    return static_cast<std::size_t>(std::ceil(frames));
}

}  // namespace

NodeTraffic::Numbers::Numbers(const HostSensor& sensor) : repeated((readings_per_s(sensor) + 1) / 2 + 1) {}

NodeTraffic::NodeTraffic(const HostNode& node, double joint_rate_hz)
    : frames_max_(2 * frames_per_s(node, joint_rate_hz) + kHeldBack),
      frames_(frames_max_),
      numbers_(node.sensors.begin(), node.sensors.end()) {}

bool NodeTraffic::keeps_with_frame(std::optional<HostTime> now) {
    return !now || frames_.keeps_with_event(*now);
}

bool NodeTraffic::keeps_with_reading(const wire::RangeReading& reading, std::optional<HostTime> now) {
    constexpr unsigned kBehind = wire::kSequenceCount / 2;
    Numbers& numbers = numbers_.at(reading.sensor);
    const auto before = std::exchange(numbers.newest, reading.sequence);
    const unsigned ahead =
        before ? (reading.sequence + 0U + wire::kSequenceCount - *before) % wire::kSequenceCount : 1;
    const bool is_new = ahead != 0 && ahead <= kBehind;
    if (is_new || !now || numbers.repeated.keeps_with_event(*now)) return true;
    numbers.doubled = now;
    return !are_most_doubled(*now);
}

bool NodeTraffic::are_most_doubled(HostTime now) const {
    constexpr Nanoseconds kSecond{1'000'000'000};
    const auto doubled = std::ranges::count_if(numbers_, [&](const Numbers& numbers) {
        return numbers.doubled && std::chrono::abs(now - *numbers.doubled) < kSecond;
    });
    return 2 * static_cast<std::size_t>(doubled) > numbers_.size();
}

}  // namespace octoskin
