// What the system says of the time of day, as a stamp.
#pragma once

#include <algorithm>
#include <cstdint>

#include "common/time.hpp"

namespace octoskin {

/// The begin of the year 2200: no clock that is right shows more. Nanoseconds since 1970 end in 2262, and
/// a sum of a stamp and a duration stays below that.
inline constexpr WallTime kWallTimeMax{7'258'118'400'000'000'000};

/// Of a clock that shows a time before 1970 or after kWallTimeMax, that border: such a clock does not tell
/// the time, and its stamps all agree.
[[nodiscard]] constexpr WallTime wall_time(std::int64_t seconds, std::int64_t nanoseconds) noexcept {
    constexpr std::int64_t kNsPerS = 1'000'000'000;
    if (seconds < 0) return {0};
    if (seconds >= kWallTimeMax.ns / kNsPerS) return kWallTimeMax;
    return {seconds * kNsPerS + std::clamp<std::int64_t>(nanoseconds, 0, kNsPerS - 1)};
}

/// A clock that shows this tells the time.
[[nodiscard]] constexpr bool tells_time(WallTime time) noexcept {
    return time.ns > 0 && time < kWallTimeMax;
}

}  // namespace octoskin
