// The node's clock: timer 2 counts microseconds in 32 bits. It also wakes the core at a given time.
#pragma once

#include <cstdint>

#include "common/time.hpp"

namespace octoskin::stm32g4 {

class MicrosecondTimer {
  public:
    /// Counts from zero at 1 MHz, its own clock running at `clock_hz`, a whole number of MHz.
    void start(std::uint32_t clock_hz);

    [[nodiscard]] NodeTime now() const;
    /// Waits without sleeping. For microseconds.
    void wait(Microseconds duration) const;

    /// Raises the timer's interrupt once, at `when` or, if that is past, at once. Replaces an earlier order.
    void wake_at(NodeTime when);
    /// From the timer's interrupt handler.
    void on_interrupt();
};

}  // namespace octoskin::stm32g4
