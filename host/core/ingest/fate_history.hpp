// Results of one sensor's newest readings: shows whether the sensor contributes to the map.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "host/core/ingest/reasons.hpp"

namespace octoskin {

/// True for reasons that only the sensor, its mounting or its settings can cause. Faults of its node, a clock
/// or the joints affect every sensor and are reported separately, as are contradictions by the camera and a
/// second sender under its id. Seeing nothing, or the robot itself, is no fault.
[[nodiscard]] bool is_of_sensor(ReadingReason reason) noexcept;

class FateHistory {
  public:
    static constexpr std::size_t kKept = 32;
    static constexpr std::size_t kStreak = 31;

    /// Empty: the reading was used. Reasons that are not the sensor's are ignored, except no_return and
    /// self_hit, which show that the sensor works.
    void note(std::optional<ReadingReason> rejected) noexcept;
    /// The most frequent reason, if at least kStreak of the last kKept readings were rejected. O(kKept).
    [[nodiscard]] std::optional<ReadingReason> streak() const noexcept;

  private:
    std::array<std::optional<ReadingReason>, kKept> newest_{};  ///< ring buffer
    std::size_t noted_ = 0;
};

}  // namespace octoskin
