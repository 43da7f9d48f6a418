// A camera stamps its frames by a clock of its own. When was that on the host's?
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>

namespace octoskin::openni2 {

/// The frame that came quickest tells best: delays only ever add. The least difference between arrival and
/// stamp within the last one to two windows is taken for the clocks' offset, so that their drift (100 ppm) is
/// followed. What the camera and its driver always take is not seen, and counts as part of the offset.
///
/// No single frame is believed: the first may have been the slowest. The offset is known once kAgreeing
/// frames came within kAgreement of the least, or a whole window has passed: on a machine so busy that hardly
/// two frames take alike the least of a window is as good as there is. The error is what the quickest frame
/// of the newest one to two windows took, and at most 1 ms of drift.
class CaptureClock {
  public:
    static constexpr std::int64_t kWindowUs = 5'000'000;
    /// A stamp this far off what the offset says is late, or of another count.
    static constexpr std::int64_t kJumpUs = 500'000;
    /// Late for so long without one that is not: it will not pass by itself.
    static constexpr std::int64_t kLateMaxUs = 5'000'000;
    static constexpr int kAgreeing = 5;
    static constexpr std::int64_t kAgreementUs = 20'000;

    /// When a frame of this stamp was captured that arrived at `arrived_us`, both in microseconds; the
    /// answer on the clock of the arrivals, and not after it. Empty while the offset is not known: at first,
    /// and when the stamps begin anew (they went back, or ahead of all delay); and for a frame that came over
    /// kJumpUs late.
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

    /// Nothing but late frames for kLateMaxUs: the camera set its clock back, or what is shown waits
    /// somewhere on its way. Which of them cannot be told from here; a camera that is opened anew has
    /// neither.
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
    std::int64_t begun_us_ = 0;  ///< arrival of the first frame of this count
    std::int64_t window_start_us_ = std::numeric_limits<std::int64_t>::min() / 2;
    std::int64_t stamp_newest_us_ = std::numeric_limits<std::int64_t>::min();
    std::int64_t last_timely_us_ = 0;  ///< arrival of the newest frame that was not late
    std::int64_t late_us_ = 0;         ///< since then, if the newest one was
    int agreeing_ = 0;                 ///< frames that told the least offset, or nearly; at most kAgreeing
};

}  // namespace octoskin::openni2
