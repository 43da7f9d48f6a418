// The clocks, as types that do not mix. One class owns the mapping between them
// (host/core/time/clock_map.hpp); nothing else converts.
#pragma once

#include <chrono>
#include <compare>
#include <cstdint>

namespace octoskin {

using Microseconds = std::chrono::duration<std::int64_t, std::micro>;
using Nanoseconds = std::chrono::duration<std::int64_t, std::nano>;

/// A reading of a node's free-running 32-bit microsecond counter. It wraps every 71 min 35 s, so it has no
/// order of its own: compare only through `elapsed()`.
struct NodeTime {
    std::uint32_t us = 0;
    friend constexpr bool operator==(NodeTime, NodeTime) = default;
};

/// `later - earlier` in microseconds, negative if `later` is in truth the earlier one. Correct over the wrap
/// as long as the two readings are less than 2^31 us (35 min 47 s) apart: the unsigned difference is exact
/// modulo 2^32, and its signed reinterpretation is then the one representative in [-2^31, 2^31).
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

/// The host's monotonic clock: nanoseconds since an arbitrary start, never stepping. 292 years do not wrap.
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

/// A receive stamp: the kernel's or a log's wall-clock time. It may step, and it never places a measurement;
/// it only says "about now" (see host/core/time/).
struct WallTime {
    std::int64_t ns = 0;
    friend constexpr auto operator<=>(WallTime, WallTime) = default;
};

}  // namespace octoskin
