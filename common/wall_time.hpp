// The system's time of day as a time stamp.
#pragma once

#include <algorithm>
#include <cstdint>

#include "common/time.hpp"

namespace octoskin {

/// The start of the year 2200, later than any correct clock. Nanoseconds since 1970 end in 2262, so a time
/// stamp plus a duration does not overflow.
inline constexpr WallTime kWallTimeMax{7'258'118'400'000'000'000};

/// The time stamp of a clock's reading, limited to the range 1970..kWallTimeMax. A clock outside this range
/// is not set; all its time stamps are equal to the limit.
[[nodiscard]] constexpr WallTime wall_time(std::int64_t seconds, std::int64_t nanoseconds) noexcept {
    constexpr std::int64_t kNsPerS = 1'000'000'000;
    if (seconds < 0) return {0};
    if (seconds >= kWallTimeMax.ns / kNsPerS) return kWallTimeMax;
    return {seconds * kNsPerS + std::clamp<std::int64_t>(nanoseconds, 0, kNsPerS - 1)};
}

/// Whether `time` comes from a clock that is set.
[[nodiscard]] constexpr bool tells_time(WallTime time) noexcept {
    return time.ns > 0 && time < kWallTimeMax;
}

}  // namespace octoskin
