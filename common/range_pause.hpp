// What the pause between two ranges of a VL53L1X must contain, for firmware and rigs: the time that a range
// takes beyond its timing budget (not published, so bounded here), and the write of the next zone.
#pragma once

#include "common/time.hpp"

namespace octoskin {

/// From the start of a range to its result, at most this much beyond its timing budget.
inline constexpr Microseconds kRangeOverheadMax{5'000};

/// The write of a zone: one register at 283 kHz, the slowest real clock of a 400 kHz bus, plus the delay of
/// the node's loop.
inline constexpr Microseconds kZoneWriteMax{400};

}  // namespace octoskin
