// The two clocks of this machine, and the conversion of a receive time stamp to the one that never steps.
#pragma once

#include <chrono>
#include <functional>
#include <optional>

#include "common/time.hpp"

namespace octoskin {

[[nodiscard]] HostTime monotonic_now();
[[nodiscard]] WallTime wall_now();

/// In seconds, for messages to a person or a script.
[[nodiscard]] constexpr double seconds_of(Nanoseconds duration) noexcept {
    return std::chrono::duration<double>(duration).count();
}

/// Both clocks at the same instant, as closely as it can be measured.
struct ClockPair {
    HostTime monotonic;
    WallTime wall;
    Nanoseconds doubt{0};  ///< between the two readings of the monotonic clock before and after the other
};

struct ClockReaders {
    std::function<HostTime()> monotonic = monotonic_now;
    std::function<WallTime()> wall = wall_now;
};

/// Reads the clocks again while the two monotonic readings are over 20 us apart, as when this thread loses
/// the processor; eight times at most. The closest reading counts.
[[nodiscard]] ClockPair read_clocks(const ClockReaders& readers = {});

/// Empty for a time stamp over a second old: the wall clock was set meanwhile. Also empty if the clocks
/// cannot be read within half a millisecond of each other: the time in a FOLLOW_UP must be right.
[[nodiscard]] std::optional<HostTime> monotonic_of(WallTime stamp, const ClockReaders& readers = {});

}  // namespace octoskin
