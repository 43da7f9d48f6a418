// What the pause between two ranges of a VL53L1X has to hold, for firmware and rigs alike: what a range takes
// beyond its timing budget, which is not public, so bounded; and the write of the next zone.
#pragma once

#include "common/time.hpp"

namespace octoskin {

/// From the start of a range to its result, this much beyond its budget at most.
inline constexpr Microseconds kRangeOverheadMax{5'000};

/// A zone's write: one register at 283 kHz, the slowest that a 400 kHz bus may really be, and what the node's
/// loop adds.
inline constexpr Microseconds kZoneWriteMax{400};

}  // namespace octoskin
