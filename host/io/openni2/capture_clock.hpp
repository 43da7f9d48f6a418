// A camera stamps its frames by a clock of its own. When was that on the host's?
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

namespace octoskin::openni2 {

/// The frame that came quickest tells best: delays only ever add. The least difference between arrival and
/// stamp within the last one to two windows is taken for the clocks' offset, so that their drift (100 ppm) is
/// followed. What the camera and its driver always take is not seen, and counts as part of the offset.
class CaptureClock {
  public:
    static constexpr std::int64_t kWindowUs = 5'000'000;
    /// A stamp this far off what the offset says is of another count: the camera started anew.
    static constexpr std::int64_t kJumpUs = 500'000;

    /// When a frame of this stamp was captured that arrived at `arrived_us`, both in microseconds; the
    /// answer on the clock of the arrivals, and not after it.
    [[nodiscard]] std::int64_t captured_us(std::int64_t stamp_us, std::int64_t arrived_us) noexcept {
        const std::int64_t offset = arrived_us - stamp_us;
        const bool is_first = least_now_ == kNone;
        if (is_first || offset < least() - kJumpUs || offset > least() + kJumpUs) {
            least_before_ = kNone;
            least_now_ = offset;
            window_start_us_ = arrived_us;
        } else if (arrived_us - window_start_us_ >= kWindowUs) {
            least_before_ = least_now_;
            least_now_ = offset;
            window_start_us_ = arrived_us;
        }
        least_now_ = std::min(least_now_, offset);
        return stamp_us + least();
    }

  private:
    static constexpr std::int64_t kNone = std::numeric_limits<std::int64_t>::max();
    [[nodiscard]] std::int64_t least() const noexcept { return std::min(least_before_, least_now_); }

    std::int64_t least_before_ = kNone;
    std::int64_t least_now_ = kNone;
    std::int64_t window_start_us_ = 0;
};

}  // namespace octoskin::openni2
