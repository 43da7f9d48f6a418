// The clocks, as types that do not mix. Only host/core/time/clock_map.hpp converts between them.
#pragma once

#include <chrono>
#include <compare>
#include <cstdint>

namespace octoskin {

using Microseconds = std::chrono::duration<std::int64_t, std::micro>;
using Nanoseconds = std::chrono::duration<std::int64_t, std::nano>;

/// A reading of a node's free-running 32-bit microsecond counter. It wraps every 71 min 35 s, so readings
/// have no order: compare them only with `elapsed()`.
struct NodeTime {
    std::uint32_t us = 0;
    friend constexpr bool operator==(NodeTime, NodeTime) = default;
};

/// `later - earlier` in microseconds; negative if `later` is the earlier one. Correct across the wrap if the
/// two readings are less than 2^31 us (35 min 47 s) apart: the unsigned difference is exact modulo 2^32, and
/// its signed reinterpretation is the representative in [-2^31, 2^31).
[[nodiscard]] constexpr Microseconds elapsed(NodeTime earlier, NodeTime later) noexcept {
    return Microseconds{static_cast<std::int32_t>(later.us - earlier.us)};
}

[[nodiscard]] constexpr NodeTime operator+(NodeTime time, Microseconds duration) noexcept {
    return {time.us + static_cast<std::uint32_t>(duration.count())};
}
[[nodiscard]] constexpr NodeTime operator-(NodeTime time, Microseconds duration) noexcept {
    return time + -duration;
}

/// True once `now` has reached `deadline` (within the 2^31 us window of `elapsed()`).
[[nodiscard]] constexpr bool is_reached(NodeTime deadline, NodeTime now) noexcept {
    return elapsed(deadline, now).count() >= 0;
}

/// The host's monotonic clock: nanoseconds since an arbitrary start. It never steps, and wraps only after 292
/// years.
struct HostTime {
    std::int64_t ns = 0;
    friend constexpr auto operator<=>(HostTime, HostTime) = default;
};
[[nodiscard]] constexpr Nanoseconds operator-(HostTime later, HostTime earlier) noexcept {
    return Nanoseconds{later.ns - earlier.ns};
}
[[nodiscard]] constexpr HostTime operator+(HostTime time, Nanoseconds duration) noexcept {
    return {time.ns + duration.count()};
}
[[nodiscard]] constexpr HostTime operator-(HostTime time, Nanoseconds duration) noexcept {
    return {time.ns - duration.count()};
}

/// A receive time stamp: the wall-clock time of the kernel or of a log. It may step, so it never dates a
/// measurement; it gives only an approximate time (see host/core/time/).
struct WallTime {
    std::int64_t ns = 0;
    friend constexpr auto operator<=>(WallTime, WallTime) = default;
};

}  // namespace octoskin
