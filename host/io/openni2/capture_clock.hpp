// Converts the time stamps of a camera, which has a clock of its own, to the host's clock.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>

namespace octoskin::openni2 {

/// The frame with the smallest delay gives the best estimate: delays only add. The smallest difference
/// between arrival and time stamp within the last one to two windows is taken as the offset of the clocks, so
/// that their drift (100 ppm) is followed. A constant delay of the camera and its driver is not visible and
/// counts as part of the offset.
/// A single frame is not sufficient: the first may have been the slowest. The offset is known after kAgreeing
/// frames within kAgreement of the smallest, or after a whole window: on a machine so busy that frames hardly
/// agree, the minimum of a window is the best available. The error is the delay of the fastest frame of the
/// last one to two windows, and at most 1 ms of drift.
class CaptureClock {
  public:
    static constexpr std::int64_t kWindowUs = 5'000'000;
    /// A time stamp this far from the expected one is late, or from a restarted count.
    static constexpr std::int64_t kJumpUs = 500'000;
    /// If all frames are late for this long, the delay will not disappear by itself.
    static constexpr std::int64_t kLateMaxUs = 5'000'000;
    static constexpr int kAgreeing = 5;
    static constexpr std::int64_t kAgreementUs = 20'000;

    /// The capture time, on the clock of the arrivals and not after the arrival, of a frame with this time
    /// stamp that arrived at `arrived_us`; both in microseconds. Empty while the offset is unknown: at first,
    /// and after a restart of the count (the time stamps went back, or ahead by more than any delay); also
    /// for a frame that arrived over kJumpUs late.
    [[nodiscard]] std::optional<std::int64_t> captured_us(std::int64_t stamp_us,
                                                          std::int64_t arrived_us) noexcept {
        const std::int64_t offset = arrived_us - stamp_us;
        const bool begins_anew = stamp_us <= stamp_newest_us_ || offset < least() - kJumpUs;
        stamp_newest_us_ = stamp_us;
        if (begins_anew) forget();
        const bool is_late = agreeing_ >= kAgreeing && offset > least() + kJumpUs;
        late_us_ = is_late ? arrived_us - last_timely_us_ : 0;
        if (is_late) return std::nullopt;
        last_timely_us_ = arrived_us;
        if (arrived_us - window_start_us_ >= kWindowUs) {
            least_before_ = least_now_;
            least_now_ = kNone;
            window_start_us_ = arrived_us;
        }
        if (least() == kNone) begun_us_ = arrived_us;
        if (agreeing_ < kAgreeing) settle(offset, arrived_us - begun_us_ >= kWindowUs);
        least_now_ = std::min(least_now_, offset);
        return agreeing_ < kAgreeing ? std::nullopt : std::optional(stamp_us + least());
    }

    /// All frames were late for kLateMaxUs: the camera set its clock back, or its frames wait in some buffer.
    /// The two cannot be distinguished here; opening the camera again ends both.
    [[nodiscard]] bool is_lost() const noexcept { return late_us_ >= kLateMaxUs; }

  private:
    static constexpr std::int64_t kNone = std::numeric_limits<std::int64_t>::max();
    [[nodiscard]] std::int64_t least() const noexcept { return std::min(least_before_, least_now_); }
    void forget() noexcept {
        least_before_ = least_now_ = kNone;
        agreeing_ = 0;
    }
    void settle(std::int64_t offset, bool has_had_a_window) noexcept {
        if (has_had_a_window) {
            agreeing_ = kAgreeing;
        } else if (least() == kNone || offset < least() - kAgreementUs) {
            agreeing_ = 1;
        } else if (offset <= least() + kAgreementUs) {
            ++agreeing_;
        }
    }

    std::int64_t least_before_ = kNone;
    std::int64_t least_now_ = kNone;
    std::int64_t begun_us_ = 0;  ///< arrival of the first frame since the count started
    std::int64_t window_start_us_ = std::numeric_limits<std::int64_t>::min() / 2;
    std::int64_t stamp_newest_us_ = std::numeric_limits<std::int64_t>::min();
    std::int64_t last_timely_us_ = 0;  ///< arrival of the latest frame that was not late
    std::int64_t late_us_ = 0;         ///< time since then, if the latest frame was late
    int agreeing_ = 0;                 ///< frames with the smallest offset, or nearly; at most kAgreeing
};

}  // namespace octoskin::openni2
