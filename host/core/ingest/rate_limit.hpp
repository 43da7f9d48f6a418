// Whether something happens more often than a limit allows, by the bus's own time.
#pragma once

#include <cstddef>
#include <vector>

#include "common/time.hpp"

namespace octoskin {

/// Exact: of all seconds that there are, wherever they begin, none may hold more than `per_second` events.
class RateLimit {
  public:
    /// At least one. Allocates its memory here, and none later.
    explicit RateLimit(std::size_t per_second);

    /// One more event; false if it is one too many for the second that ends with it. Before the newest one
    /// it counts as if at that; a second or more before, those until then were of another time. O(1).
    [[nodiscard]] bool keeps_with_event(HostTime at);

  private:
    std::vector<HostTime> times_;  ///< of the last `per_second` events, a ring
    std::size_t next_ = 0;         ///< where the oldest is, once all are taken
    std::size_t taken_ = 0;
    HostTime newest_;
};

}  // namespace octoskin
