// What a range of a VL53L1X takes beyond its timing budget: not public, so bounded, for firmware and rigs
// alike.
#pragma once

#include "common/time.hpp"

namespace octoskin {

/// From the start of a range to its result, this much beyond its budget at most.
inline constexpr Microseconds kRangeOverheadMax{5'000};

}  // namespace octoskin
