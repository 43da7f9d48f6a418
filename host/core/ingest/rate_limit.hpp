// Checks whether events occur more often than a limit allows, by host time.
#pragma once

#include <cstddef>
#include <vector>

#include "common/time.hpp"

namespace octoskin {

/// Exact: no interval of one second, wherever it begins, may contain more than `per_second` events.
class RateLimit {
  public:
    /// `per_second`: at least one. Allocates its memory here, and none later.
    explicit RateLimit(std::size_t per_second);

    /// Adds an event; false if it exceeds the limit in the second that ends with it. An event before the
    /// newest counts as simultaneous with it; one a second or more before starts a new count, because the
    /// time jumped. O(1).
    [[nodiscard]] bool keeps_with_event(HostTime at);

  private:
    std::vector<HostTime> times_;  ///< times of the last `per_second` events, a ring buffer
    std::size_t next_ = 0;         ///< position of the oldest, once the buffer is full
    std::size_t taken_ = 0;
    HostTime newest_;
};

}  // namespace octoskin
