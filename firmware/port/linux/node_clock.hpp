// The node's clock on Linux: CLOCK_MONOTONIC in microseconds, truncated to 32 bits as on every node.
#pragma once

#include <cstdint>
#include <ctime>

#include "common/time.hpp"

namespace octoskin::linux_port {

/// Wraps after 71 minutes.
[[nodiscard]] NodeTime node_now() noexcept;

/// The two clocks at one instant.
struct ClockPair {
    NodeTime node;
    WallTime wall;
};
/// Reads both clocks: CLOCK_MONOTONIC before and after CLOCK_REALTIME, the shortest interval of three tries.
[[nodiscard]] ClockPair read_clocks() noexcept;

/// Converts a kernel time stamp (wall clock) to the node's clock, by its age at `now`. If the age is not
/// within 0 to 1 s (the wall clock was set), the result is `now`.
[[nodiscard]] NodeTime node_time_of(WallTime stamp, const ClockPair& now) noexcept;

}  // namespace octoskin::linux_port
