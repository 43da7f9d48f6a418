// The node's clock on Linux: CLOCK_MONOTONIC in microseconds, cut to the 32 bits of every node's.
#pragma once

#include <cstdint>
#include <ctime>

#include "common/time.hpp"

namespace octoskin::linux_port {

[[nodiscard]] NodeTime node_now() noexcept;

/// What two clocks read at one instant.
struct ClockPair {
    NodeTime node;
    WallTime wall;
};
/// Reads both within as short a time as can be had: CLOCK_MONOTONIC before and after CLOCK_REALTIME, the
/// narrowest of three.
[[nodiscard]] ClockPair read_clocks() noexcept;

/// The kernel stamps frames by the wall clock. `stamp` on the node's clock, by its age at `now`; a stamp
/// that is not of the last second (somebody has set the wall clock) is taken for `now`.
[[nodiscard]] NodeTime node_time_of(WallTime stamp, const ClockPair& now) noexcept;

}  // namespace octoskin::linux_port
