// The node's clock without its wrap, for times on an even grid. A wrap would shift the phases of the sensors
// that start after it against all others.
#pragma once

#include <cstdint>

#include "common/time.hpp"

namespace octoskin::node {

class PhaseClock {
  public:
    explicit PhaseClock(NodeTime now) noexcept : us_(now.us) {}

    /// Call at least every 35 minutes.
    void advance(NodeTime now) noexcept { us_ = us_at(now); }
    /// For a time within 35 minutes of the last `advance`.
    [[nodiscard]] std::uint64_t us_at(NodeTime time) const noexcept {
        const Microseconds since = elapsed(NodeTime{static_cast<std::uint32_t>(us_)}, time);
        return us_ + static_cast<std::uint64_t>(since.count());
    }

  private:
    std::uint64_t us_;
};

}  // namespace octoskin::node
