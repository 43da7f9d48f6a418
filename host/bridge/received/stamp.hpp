// The time of a message on this machine's monotonic clock.
#pragma once

#include <cstdint>

#include "common/result.hpp"
#include "common/time.hpp"

namespace octoskin::bridge {

/// How far a stamp may be from this machine's wall clock when the message arrives. Older: its sender's clock
/// is behind, or it was on its way for too long to place a range by it.
inline constexpr Nanoseconds kAheadMax{5'000'000};
inline constexpr Nanoseconds kBehindMax{150'000'000};

enum class StampFault : std::uint8_t { ahead, behind };

/// Both clocks at the arrival of a message.
struct Arrival {
    HostTime monotonic;
    WallTime wall;
};

/// A stamp of 0 means that the sender does not know the time: the message is from its arrival.
[[nodiscard]] inline Result<HostTime, StampFault> time_of_stamp(WallTime stamp,
                                                                const Arrival& arrival) noexcept {
    if (stamp.ns == 0) return arrival.monotonic;
    const Nanoseconds age{arrival.wall.ns - stamp.ns};
    if (age < -kAheadMax) return unexpected(StampFault::ahead);
    if (age > kBehindMax) return unexpected(StampFault::behind);
    return arrival.monotonic - age;
}

/// A time of the bus as wall time. The bus has this machine's clock, unless another host sends SYNC: then the
/// message is from now.
[[nodiscard]] inline WallTime wall_of(HostTime bus, const Arrival& arrival) noexcept {
    constexpr Nanoseconds kOwnClock{10'000'000'000};
    const Nanoseconds age = arrival.monotonic - bus;
    const bool is_own = age < kOwnClock && age > -kOwnClock;
    return is_own ? WallTime{arrival.wall.ns - age.count()} : arrival.wall;
}

}  // namespace octoskin::bridge
