// The time of a message's content in a bag.
#pragma once

#include <optional>

#include "common/time.hpp"
#include "host/bridge/published/ros_values.hpp"
#include "host/bridge/recorded/bus_clock.hpp"

namespace octoskin::bridge {

/// Whether a log can hold it, and its distance from every other such time fits 64 bits.
[[nodiscard]] constexpr bool is_log_time(WallTime time) noexcept {
    constexpr std::int64_t kMax_ns = std::int64_t{1} << 62;  // the year 2116
    return time.ns >= 0 && time.ns <= kMax_ns;
}

/// Whether frames of this time can carry the time of their bus: 48 bits of microseconds. The last 100 days
/// are for frames that have to wait for those before them.
[[nodiscard]] inline bool has_bus_time(const BusClock& clock, WallTime time) noexcept {
    constexpr std::int64_t kRoom_ns = std::int64_t{100} * 24 * 3600 * 1'000'000'000;
    constexpr std::int64_t kEnd_ns = (std::int64_t{1} << 48) * 1000 - kRoom_ns;
    if (!is_log_time(time)) return false;
    const std::int64_t bus_ns = clock.bus_of(time).ns;
    return bus_ns >= 0 && bus_ns < kEnd_ns;
}

/// The stamp of its header; a stamp of 0, or `uses_log_time`: when it was logged. Empty: the stamp is more
/// than a second from that, so that it is of another clock, or no log can hold it.
[[nodiscard]] inline std::optional<WallTime> time_of(WallTime stamp, WallTime logged, bool uses_log_time) {
    constexpr std::int64_t kApart_ns = 1'000'000'000;
    if (!is_log_time(logged)) return std::nullopt;
    if (uses_log_time || stamp.ns == 0) return logged;
    const bool is_near = stamp.ns - logged.ns <= kApart_ns && logged.ns - stamp.ns <= kApart_ns;
    return is_near ? std::optional(stamp) : std::nullopt;
}

}  // namespace octoskin::bridge
