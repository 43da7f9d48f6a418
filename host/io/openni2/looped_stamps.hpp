// A film that is played again and again: its stamps begin anew with each round, and time goes on.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

namespace octoskin::openni2 {

/// Stamps that run on from round to round. A film is shown at its own speed, but how long it takes to begin
/// anew nobody tells: each round begins as far behind its first frame's arrival as the first round did, and
/// so no delay of one round is left to the next.
class LoopedStamps {
  public:
    /// Of the frame with this stamp that arrived then, both in microseconds: larger than of the one before.
    [[nodiscard]] std::int64_t running_us(std::int64_t stamp_us, std::int64_t arrived_us) noexcept {
        if (!delay_us_) delay_us_ = arrived_us - stamp_us;
        const bool begins_anew = newest_ && stamp_us <= newest_->stamp_us;
        if (begins_anew) shift_us_ = std::max(newest_->running_us + 1, arrived_us - *delay_us_) - stamp_us;
        newest_ = {stamp_us, stamp_us + shift_us_};
        return newest_->running_us;
    }

  private:
    struct Stamp {
        std::int64_t stamp_us = 0;
        std::int64_t running_us = 0;
    };
    std::optional<std::int64_t> delay_us_;  ///< of the first frame of all
    std::optional<Stamp> newest_;
    std::int64_t shift_us_ = 0;  ///< of this round
};

}  // namespace octoskin::openni2
