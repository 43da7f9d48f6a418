// Whether a reading comes when those before it say that it must: its sensor ranges once a period, so that its
// number tells its time. A clock that jumped between the two shows.
#pragma once

#include <cstdint>
#include <optional>

#include "common/time.hpp"

namespace octoskin {

class Cadence {
  public:
    /// `period`: as configured; what the sensor truly does is measured.
    explicit Cadence(Nanoseconds period) : period_(period) {}

    /// The time is the one that the number has by the last confirmed step, to within an eighth of a period
    /// and 3 ms. False while there is none, or over half a turn of the numbers after it.
    [[nodiscard]] bool fits(std::uint8_t sequence, HostTime captured) const;
    /// A reading was accepted, later than those before.
    void on_accepted(std::uint8_t sequence, HostTime captured);
    /// An exchange showed that the node's clock goes on: the newest two readings tell the period.
    void confirm();
    /// The numbers begin anew, or the times of the newest readings were wrong.
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
    std::optional<Step> step_;  ///< the newest that is in step with a confirmed one
    std::optional<Step> newest_;
    std::optional<Step> before_;
};

}  // namespace octoskin
