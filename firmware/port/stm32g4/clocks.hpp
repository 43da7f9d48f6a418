// Starts the clocks: 160 MHz from the crystal, or, if that is dead, from the internal oscillator.
#pragma once

#include <cstdint>

#include "firmware/port/stm32g4/microsecond_timer.hpp"

namespace octoskin::stm32g4 {

enum class ClockSource : std::uint8_t {
    crystal,   ///< 160 MHz, good enough for CAN
    internal,  ///< 160 MHz, 1 % off: the crystal did not start
    unlocked,  ///< 1 % off, and slow: the PLL did not lock, or the core could not be switched to it
};

struct Clocks {
    ClockSource source = ClockSource::unlocked;
    std::uint32_t core_hz = 0;  ///< also of all buses, timers, I2C and the UART
    std::uint32_t can_hz = 0;   ///< 0: no clock that CAN may use
};

/// From the state after reset. Uses the timer for its deadlines and leaves it running at 1 MHz, begun anew at
/// zero. Takes 50 ms if the crystal is dead, else about 3. With the crystal, clock security is on: if it
/// fails later, the NMI is raised. What it returns is how fast the core truly runs, whatever failed.
[[nodiscard]] Clocks start_clocks(MicrosecondTimer& timer);

/// While everything runs without it: asks the crystal to start, and tells whether it runs. Never waits.
[[nodiscard]] bool is_crystal_running();

}  // namespace octoskin::stm32g4
