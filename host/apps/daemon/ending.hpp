// How long the daemon's end may take, and what it says then.
#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>

#include "common/time.hpp"

namespace octoskin {

/// The exit code of a defect of octoskin.
inline constexpr int kInternalDefect = 70;

/// For what is being saved when the end comes, the last save, and what is being recorded. The camera may take
/// another second, what is left behind 0.2 s: 5 s in all. A large map has as long as a disk with 50 MB/s
/// takes to write it twice, as a save may just have begun. The .ot of dense space is 1.4 times the memory,
/// its snapshot with counts and times 1.8 times.
[[nodiscard]] Nanoseconds end_patience(std::size_t map_bytes) noexcept;

/// Beyond that: with a small map the 10 s of the unit's TimeoutStopSec.
inline constexpr Nanoseconds kEndMargin{6'500'000'000};

/// The service manager waits as long, and its watchdog too: the loop that feeds it has ended.
void tell_end(Nanoseconds patience);

/// How long the start may take to read `bytes` of saved maps: as long as a disk with 25 MB/s takes, and the
/// unit's 90 s besides.
[[nodiscard]] Nanoseconds load_patience(std::uint64_t bytes) noexcept;
/// The service manager waits as long for the daemon to have begun.
void tell_load(Nanoseconds patience);

/// Logs it; the exit code for it.
[[nodiscard]] int tell_why_it_ends(const std::exception& thrown);

}  // namespace octoskin
