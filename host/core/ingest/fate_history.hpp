// What became of one sensor's newest readings: whether it is of any use to the map.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "host/core/ingest/reasons.hpp"

namespace octoskin {

/// True for what only the sensor, its place or its settings can be blamed for. What its node, a clock or the
/// joints lack stops every sensor, and has a name of its own, as have what the camera says of it and a second
/// sender under its name; to see nothing, or the robot itself, is no fault.
[[nodiscard]] bool is_of_sensor(ReadingReason reason) noexcept;

class FateHistory {
  public:
    static constexpr std::size_t kKept = 32;
    static constexpr std::size_t kStreak = 31;

    /// Empty: it was used. Reasons that are not the sensor's are left out, but for no_return and self_hit:
    /// such a sensor works.
    void note(std::optional<ReadingReason> rejected) noexcept;
    /// The most frequent reason, if kStreak of the last kKept were rejected. O(kKept).
    [[nodiscard]] std::optional<ReadingReason> streak() const noexcept;

  private:
    std::array<std::optional<ReadingReason>, kKept> newest_{};  ///< a ring
    std::size_t noted_ = 0;
};

}  // namespace octoskin
