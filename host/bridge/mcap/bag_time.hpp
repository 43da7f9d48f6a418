// The time of a message's content in a bag.
#pragma once

#include <optional>

#include "common/time.hpp"
#include "host/bridge/published/ros_values.hpp"

namespace octoskin::bridge {

/// The stamp of its header; a stamp of 0, or `uses_log_time`: when it was logged. Empty: the stamp is more
/// than a second from that, so that it is of another clock.
[[nodiscard]] inline std::optional<WallTime> time_of(WallTime stamp, WallTime logged, bool uses_log_time) {
    constexpr std::int64_t kApart_ns = 1'000'000'000;
    if (uses_log_time || stamp.ns == 0) return logged;
    const bool is_near = stamp.ns - logged.ns <= kApart_ns && logged.ns - stamp.ns <= kApart_ns;
    return is_near ? std::optional(stamp) : std::nullopt;
}

}  // namespace octoskin::bridge
