// Starts the clocks: 160 MHz from the crystal, or, if that is dead, from the internal oscillator.
#pragma once

#include <cstdint>

#include "firmware/port/stm32g4/microsecond_timer.hpp"

namespace octoskin::stm32g4 {

enum class ClockSource : std::uint8_t {
    crystal,   ///< 160 MHz, good enough for CAN
    internal,  ///< 160 MHz, 1 % off: the crystal did not start
    unlocked,  ///< 16 MHz, 1 % off: the PLL did not lock either
};

struct Clocks {
    ClockSource source = ClockSource::unlocked;
    std::uint32_t core_hz = 0;  ///< also of all buses, timers, I2C and the UART
    std::uint32_t can_hz = 0;   ///< 0: no clock that CAN may use
};

/// From the state after reset. Uses the timer for its deadlines and leaves it running at 1 MHz, begun anew at
/// zero. Takes 10 ms if the crystal is dead, else about 1. With the crystal, clock security is on: if it
/// fails later, the NMI is raised.
[[nodiscard]] Clocks start_clocks(MicrosecondTimer& timer);

}  // namespace octoskin::stm32g4
