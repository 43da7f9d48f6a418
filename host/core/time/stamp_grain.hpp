// How coarse the receive stamps of a log are: adapters on a serial line hand frames over in batches.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "common/time.hpp"

namespace octoskin {

/// Two frames of a bus are at least 47 us apart, so stamps with microseconds differ. Where one frame in ten
/// and more has the stamp of the one before, stamps are those of batches, or were rounded: each is off by up
/// to the distance between two batches. A stamp is never taken for a time that places a measurement
/// (ClockMap); it only says which of several readings of a wrapping field is meant.
class StampGrain {
  public:
    static constexpr std::uint64_t kFramesEnough = 1000;
    /// Within what is always allowed for (HostClockConfig::back_tolerance).
    static constexpr Nanoseconds kHarmless{5'000'000};
    /// "Now" may be off by so much and still tell which turn of a range's time field is meant, if the stamps
    /// do not jump by over kAheadMax besides: 262 ms of the field, less 100 ms between a range's window and
    /// the end of its age limit, less twice (5 ms + this).
    static constexpr Nanoseconds kBridgedMax{16'000'000};
    static constexpr Nanoseconds kAheadMax{120'000'000};

    /// Stamps of one interface, in the order of arrival.
    void take(WallTime stamp) noexcept;
    [[nodiscard]] bool has_enough() const noexcept { return frames_ >= kFramesEnough; }

    /// The distance that nine in ten pairs of neighbouring batches keep at most, rounded up to milliseconds;
    /// 0 where stamps are each frame's own, or within kHarmless. At most 2 s.
    [[nodiscard]] Nanoseconds grain() const noexcept;

  private:
    static constexpr std::size_t kMsMax = 2'000;

    std::optional<WallTime> newest_;
    std::uint64_t frames_ = 0;
    std::uint64_t equal_ = 0;                       ///< frames with the stamp of the one before
    std::array<std::uint32_t, kMsMax + 1> gaps_{};  ///< between batches, by milliseconds, the last: and more
};

/// For a person: what stamps of this grain mean for a replay, and what mends them; empty for 0.
[[nodiscard]] std::optional<std::string> describe_stamps(Nanoseconds grain);

}  // namespace octoskin
