// This machine's two clocks, and what a receive stamp is on the one that never steps.
#pragma once

#include <chrono>
#include <functional>
#include <optional>

#include "common/time.hpp"

namespace octoskin {

[[nodiscard]] HostTime monotonic_now();
[[nodiscard]] WallTime wall_now();

/// As a figure, for what a person or a script is told.
[[nodiscard]] constexpr double seconds_of(Nanoseconds duration) noexcept {
    return std::chrono::duration<double>(duration).count();
}

/// Both clocks at one instant, as closely as can be told.
struct ClockPair {
    HostTime monotonic;
    WallTime wall;
    Nanoseconds doubt{0};  ///< between the two readings of the monotonic clock around that of the other
};

struct ClockReaders {
    std::function<HostTime()> monotonic = monotonic_now;
    std::function<WallTime()> wall = wall_now;
};

/// This thread may lose the processor between two readings: read again while they are over 20 us apart, eight
/// times at most; the closest ones count.
[[nodiscard]] ClockPair read_clocks(const ClockReaders& readers = {});

/// Empty for a stamp that is not of the last second: the wall clock was set meanwhile. And if the clocks
/// cannot be read within half a millisecond of each other: what a FOLLOW_UP tells must be true.
[[nodiscard]] std::optional<HostTime> monotonic_of(WallTime stamp, const ClockReaders& readers = {});

}  // namespace octoskin
