// The longest duration of a range of one part. What it takes beyond its timing budget is not published, and
// its beginning cannot be observed. A stop gives the information: a range that was under way still ends with
// a result (UM2510 3.5.7); if none comes, none had begun.
//
// Nothing is written to a sensor while a range may be under way, and a range begins up to 5 ms before its
// window (kRangeOverheadMax). A sensor that is stopped more than 5 ms before its next window is restarted at
// once: this costs one reading. Where the period leaves no room for it (50 Hz), the node waits until a range
// would be over and looks for its result. If there is one, it is a reading, and again one is given up. If
// there is none, two are given up. But then no range was under way at that stop, nor will be at any that
// comes sooner. Such a stop is therefore made 1 ms later than it could be (`Policy::phase_stop_delay`): the
// next ones can then be sooner and need no wait.
#pragma once

#include <algorithm>

#include "common/range_pause.hpp"
#include "common/time.hpp"
#include "firmware/core/time_bracket.hpp"

namespace octoskin::node {

class RangeLength {
  public:
    explicit RangeLength(Microseconds timing_budget) noexcept : longest_(timing_budget + kRangeOverheadMax) {}

    /// Whether at `now` the range that will be ready at `ready` or later has certainly not begun.
    [[nodiscard]] bool is_before(NodeTime now, NodeTime ready) const noexcept {
        return is_reached(now + longest_, ready);
    }
    /// The part was stopped at `stopped` or later, and the range that would have been ready within `ready`
    /// did not come.
    void on_none_begun(NodeTime stopped, const TimeBracket& ready) noexcept {
        // Oscillators drift by less than this share of a range of 50 ms between two uses.
        constexpr Microseconds kDrift{250};
        longest_ = std::min(longest_, elapsed(stopped, ready.latest) + kDrift);
    }

  private:
    Microseconds longest_;
};

}  // namespace octoskin::node
