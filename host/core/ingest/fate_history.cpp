#include "host/core/ingest/fate_history.hpp"

#include <algorithm>

namespace octoskin {

namespace {

/// The sensor works: nothing is in range, or only the robot's own body, as in many poses.
bool is_well(ReadingReason reason) noexcept {
    return reason == ReadingReason::no_return || reason == ReadingReason::self_hit;
}

}  // namespace

bool is_of_sensor(ReadingReason reason) noexcept {
    if (reason == ReadingReason::contradicts_reading || reason == ReadingReason::sensor_disputed)
        return false;
    const bool is_at_gate =
        reason >= ReadingReason::time_uncertain && reason <= ReadingReason::sigma_above_max;
    const bool is_in_map = reason > ReadingReason::self_hit && reason != ReadingReason::contradicts_camera;
    return (is_at_gate && !is_well(reason)) || is_in_map;
}

void FateHistory::note(std::optional<ReadingReason> rejected) noexcept {
    if (rejected && is_well(*rejected)) {
        rejected.reset();
    } else if (rejected && !is_of_sensor(*rejected)) {
        return;
    }
    newest_[noted_++ % kKept] = rejected;
}

std::optional<ReadingReason> FateHistory::streak() const noexcept {
    const auto rejected = std::ranges::count_if(newest_, [](const auto& fate) { return fate.has_value(); });
    if (noted_ < kKept || static_cast<std::size_t>(rejected) < kStreak) {
        return std::nullopt;
    }
    const auto count = [this](const auto& fate) { return fate ? std::ranges::count(newest_, fate) : 0; };
    return *std::ranges::max_element(newest_, {}, count);
}

}  // namespace octoskin
