// Starts the clocks: 160 MHz from the crystal or, if it fails, from the internal oscillator.
#pragma once

#include <cstdint>

#include "firmware/port/stm32g4/microsecond_timer.hpp"

namespace octoskin::stm32g4 {

enum class ClockSource : std::uint8_t {
    crystal,   ///< 160 MHz, good enough for CAN
    internal,  ///< 160 MHz, 1 % off: the crystal did not start
    unlocked,  ///< 1 % off, and slower: the PLL did not lock, or the core could not be switched to it
};

struct Clocks {
    ClockSource source = ClockSource::unlocked;
    std::uint32_t core_hz = 0;  ///< also the clock of all buses, timers, I2C and the UART
    std::uint32_t can_hz = 0;   ///< 0: no clock accurate enough for CAN
};

/// Call in the state after reset. Uses the timer for its deadlines and leaves it running at 1 MHz, restarted
/// from zero. Takes about 3 ms, or 50 ms without the crystal. With the crystal, the clock security system is
/// on: a later failure of the crystal raises the NMI. After any failure the returned values are the actual
/// frequencies.
[[nodiscard]] Clocks start_clocks(MicrosecondTimer& timer);

/// For a chip that runs without the crystal: starts the crystal and returns whether it runs. Never waits.
[[nodiscard]] bool is_crystal_running();

}  // namespace octoskin::stm32g4
