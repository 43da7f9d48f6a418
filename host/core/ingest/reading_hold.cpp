#include "host/core/ingest/reading_hold.hpp"

#include <algorithm>
#include <utility>

namespace octoskin {

bool ReadingHold::put(const RangeMeasurement& measurement, std::uint8_t sequence, HostTime until) {
    const Key key{measurement.source.node_id, measurement.source.sensor, sequence};
    return waiting_.try_emplace(key, Waiting{measurement, until}).second;
}

std::size_t ReadingHold::drop(wire::NodeId node, std::uint8_t sensor, std::uint8_t sequence) {
    return waiting_.erase({node, sensor, sequence});
}

std::size_t ReadingHold::drop(wire::NodeId node, std::uint8_t sensor) {
    return std::erase_if(waiting_, [&](const auto& entry) {
        return std::get<0>(entry.first) == node && std::get<1>(entry.first) == sensor;
    });
}

std::vector<RangeMeasurement> ReadingHold::take_due(HostTime now) {
    constexpr Nanoseconds kLeapt{1'000'000'000};  // no hold is a quarter as long
    std::vector<RangeMeasurement> due;
    std::erase_if(waiting_, [&](const auto& entry) {
        const Waiting& waiting = entry.second;
        const bool is_due = now >= waiting.until || waiting.until - now > kLeapt;
        if (is_due) due.push_back(waiting.measurement);
        return is_due;
    });
    std::ranges::stable_sort(due, {}, &RangeMeasurement::captured);
    return due;
}

std::vector<RangeMeasurement> ReadingHold::take_all() {
    std::vector<RangeMeasurement> all;
    for (const auto& [key, waiting] : std::exchange(waiting_, {})) all.push_back(waiting.measurement);
    std::ranges::stable_sort(all, {}, &RangeMeasurement::captured);
    return all;
}

}  // namespace octoskin
