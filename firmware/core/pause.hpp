// A pause that, once over, stays over. A stored time that is compared after more than 35 minutes would lie in
// the future again, because the clock wraps.
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
    /// As of the last `update`; also before the first `begin`.
    [[nodiscard]] bool is_over() const noexcept { return !end_; }
    /// Empty once it is over.
    [[nodiscard]] std::optional<NodeTime> end() const noexcept { return end_; }

  private:
    std::optional<NodeTime> end_;
};

}  // namespace octoskin::node
