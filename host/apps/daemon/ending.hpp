// How long the start and the end of the daemon may take, and its messages to the service manager.
#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>

#include "common/time.hpp"

namespace octoskin {

/// The exit code of a defect of octoskin.
inline constexpr int kInternalDefect = 70;

/// The time for a save in progress, the last save and the recording: 5 s in all. The camera may take another
/// second, threads left behind 0.2 s. A large map gets the time in which a disk with 50 MB/s writes it twice,
/// because a save may have just begun. The .ot of dense space is 1.4 times its memory, its snapshot with
/// counts and times 1.8 times.
[[nodiscard]] Nanoseconds end_patience(std::size_t map_bytes) noexcept;

/// Added to it: with a small map the sum is about the 10 s of the unit's TimeoutStopSec.
inline constexpr Nanoseconds kEndMargin{6'500'000'000};

/// Asks the service manager to wait that long, and its watchdog too: the loop that feeds it has ended.
void report_end(Nanoseconds patience);

/// How long the start may take to read `bytes` of saved maps: the time of a disk with 25 MB/s, plus the 90 s
/// of the unit.
[[nodiscard]] Nanoseconds load_patience(std::uint64_t bytes) noexcept;
/// Asks the service manager to wait that long for the daemon's start.
void report_load(Nanoseconds patience);

/// Logs the reason, and returns the exit code for it.
[[nodiscard]] int report_why_it_ends(const std::exception& thrown);

}  // namespace octoskin
