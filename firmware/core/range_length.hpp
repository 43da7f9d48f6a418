// How long a range of one part takes at most. What it takes beyond its timing budget is not public, and its
// beginning cannot be seen from outside; but a stop tells: a range that was under way still ends with a
// result (UM2510 3.5.7), and if none comes, none had begun.
#pragma once

#include <algorithm>

#include "common/range_pause.hpp"
#include "common/time.hpp"
#include "firmware/core/time_bracket.hpp"

namespace octoskin::node {

class RangeLength {
  public:
    explicit RangeLength(Microseconds timing_budget) noexcept : longest_(timing_budget + kRangeOverheadMax) {}

    /// Whether at `now` the range that will be ready at `ready` or later has surely not begun.
    [[nodiscard]] bool is_before(NodeTime now, NodeTime ready) const noexcept {
        return is_reached(now + longest_, ready);
    }
    /// The part was stopped at `stopped` or later, and the range did not come that would have been ready
    /// within `ready`.
    void on_none_begun(NodeTime stopped, const TimeBracket& ready) noexcept {
        // Oscillators drift by less than this, of a range of 50 ms, between two turns.
        constexpr Microseconds kDrift{250};
        longest_ = std::min(longest_, elapsed(stopped, ready.latest) + kDrift);
    }

  private:
    Microseconds longest_;
};

}  // namespace octoskin::node
