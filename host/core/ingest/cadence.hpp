// Checks that a reading arrives when the readings before it predict. A sensor ranges once a period, so that
// the sequence number determines the time. A jump of the node's clock between two readings becomes visible.
#pragma once

#include <cstdint>
#include <optional>

#include "common/time.hpp"

namespace octoskin {

class Cadence {
  public:
    /// `period`: as configured. The actual period is measured.
    explicit Cadence(Nanoseconds period) : period_(period) {}

    /// True if the time matches the sequence number, counted from the last confirmed step, to within an
    /// eighth of a period and 3 ms. False while there is no such step, or more than half a wrap of the
    /// numbers after it.
    [[nodiscard]] bool fits(std::uint8_t sequence, HostTime captured) const;
    /// An accepted reading that is later than those before.
    void on_accepted(std::uint8_t sequence, HostTime captured);
    /// An exchange confirmed the node's clock: the newest two readings give the period.
    void confirm();
    /// The numbers restart, or the times of the newest readings were wrong.
    void restart() noexcept {
        step_.reset();
        newest_.reset();
        before_.reset();
    }

  private:
    struct Step {
        std::uint8_t sequence = 0;
        HostTime captured;
    };
    Nanoseconds period_;
    std::optional<Step> step_;  ///< the newest reading in step with a confirmed one
    std::optional<Step> newest_;
    std::optional<Step> before_;
};

}  // namespace octoskin
