// The node's clock: timer 2 counts microseconds in 32 bits. It also wakes the core at a given time.
#pragma once

#include <cstdint>

#include "common/time.hpp"

namespace octoskin::stm32g4 {

class MicrosecondTimer {
  public:
    /// Starts counting from zero at 1 MHz. `clock_hz`: the timer's input clock, a whole number of MHz.
    void start(std::uint32_t clock_hz);

    [[nodiscard]] NodeTime now() const;
    /// Busy wait, for a few microseconds.
    void wait(Microseconds duration) const;

    /// Raises the timer's interrupt once, at `when` or, if that is past, at once. Replaces an earlier
    /// request.
    void wake_at(NodeTime when);
    /// Call from the timer's interrupt handler.
    void on_interrupt();
};

}  // namespace octoskin::stm32g4
