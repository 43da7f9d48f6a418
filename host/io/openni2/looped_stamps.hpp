// A film that is played again and again: its stamps begin anew with each round, and time goes on.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>

namespace octoskin::openni2 {

/// Stamps that run on from round to round. A film is shown at its own speed, but how long it takes to begin
/// anew nobody tells: each round's first frame is taken for as quick as the quickest so far. So no delay of
/// one round, or of the very first frame, is left to the next.
class LoopedStamps {
  public:
    /// Of the frame with this stamp that arrived then, both in microseconds: larger than of the one before.
    [[nodiscard]] std::int64_t running_us(std::int64_t stamp_us, std::int64_t arrived_us) noexcept {
        const bool begins_anew = newest_ && stamp_us <= newest_->stamp_us;
        if (begins_anew)
            shift_us_ = std::max(newest_->running_us + 1, arrived_us - least_delay_us_) - stamp_us;
        newest_ = {stamp_us, stamp_us + shift_us_};
        least_delay_us_ = std::min(least_delay_us_, arrived_us - newest_->running_us);
        return newest_->running_us;
    }

  private:
    struct Stamp {
        std::int64_t stamp_us = 0;
        std::int64_t running_us = 0;
    };
    std::int64_t least_delay_us_ = std::numeric_limits<std::int64_t>::max();  ///< of all frames so far
    std::optional<Stamp> newest_;
    std::int64_t shift_us_ = 0;  ///< of this round
};

}  // namespace octoskin::openni2
