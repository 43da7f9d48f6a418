// A time that runs out and then stays run out, however long ago that was: a time kept and compared later than
// 35 minutes would lie in the future again, as the clock wraps.
#pragma once

#include <optional>

#include "common/time.hpp"

namespace octoskin::node {

class Pause {
  public:
    void begin(NodeTime now, Microseconds length) noexcept { end_ = now + length; }
    /// Call at least every 35 minutes.
    void update(NodeTime now) noexcept {
        if (end_ && is_reached(*end_, now)) end_.reset();
    }
    /// As of the last `update`; before the first `begin` too.
    [[nodiscard]] bool is_over() const noexcept { return !end_; }
    /// Empty once it is over.
    [[nodiscard]] std::optional<NodeTime> end() const noexcept { return end_; }

  private:
    std::optional<NodeTime> end_;
};

}  // namespace octoskin::node
