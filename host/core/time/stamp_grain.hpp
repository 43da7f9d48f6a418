// Measures how coarse the receive time stamps of a log are: adapters on a serial line deliver frames in
// batches.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "common/time.hpp"

namespace octoskin {

/// Two frames of a bus are at least 47 us apart, so time stamps with microseconds differ. If at least one
/// frame in ten has the same time stamp as the one before, time stamps belong to batches or are rounded: each
/// is wrong by up to the distance between two batches. A time stamp never places a measurement (ClockMap); it
/// only selects between several readings of a wrapping field.
class StampGrain {
  public:
    static constexpr std::uint64_t kFramesEnough = 1000;
    /// Within the tolerance that always applies (HostClockConfig::back_tolerance).
    static constexpr Nanoseconds kHarmless{5'000'000};
    /// "Now" may be wrong by this much and still select the right turn of a range's time field, if the time
    /// stamps do not also jump by over kAheadMax: 262 ms of the field, less 100 ms between a range's window
    /// and the end of its age limit, less twice (5 ms + this).
    static constexpr Nanoseconds kBridgedMax{16'000'000};
    static constexpr Nanoseconds kAheadMax{120'000'000};

    /// Takes the time stamps of one interface, in the order of arrival.
    void take(WallTime stamp) noexcept;
    [[nodiscard]] bool has_enough() const noexcept { return frames_ >= kFramesEnough; }

    /// The distance within which nine in ten pairs of neighbouring batches lie, rounded up to milliseconds. 0
    /// if each frame has its own time stamp, or if the distance is within kHarmless. At most 2 s.
    [[nodiscard]] Nanoseconds grain() const noexcept;

  private:
    static constexpr std::size_t kMsMax = 2'000;

    std::optional<WallTime> newest_;
    std::uint64_t frames_ = 0;
    std::uint64_t equal_ = 0;                       ///< frames with the same time stamp as the one before
    std::array<std::uint32_t, kMsMax + 1> gaps_{};  ///< between batches, by milliseconds; the last: and more
};

/// Text for the user: the effect of time stamps of this grain on a replay, and the remedy; empty for 0.
[[nodiscard]] std::optional<std::string> describe_stamps(Nanoseconds grain);

}  // namespace octoskin
