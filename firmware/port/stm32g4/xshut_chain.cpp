#include "firmware/port/stm32g4/xshut_chain.hpp"

#include <cassert>

#include "firmware/port/stm32g4/cpu.hpp"
#include "firmware/port/stm32g4/pin.hpp"

namespace octoskin::stm32g4 {

namespace {

// Adjacent free pins on the NUCLEO's CN7. PB4 and PB6 have pull-downs, and PB8 is BOOT0.
constexpr Pin kData{gpio_c, 0};        // SER
constexpr Pin kShift{gpio_c, 1};       // SRCLK, rising edge
constexpr Pin kShow{gpio_c, 2};        // RCLK, rising edge
constexpr Pin kOutputsOff{gpio_c, 3};  // OE, active low, with an external pull-up

/// Half a clock: at least 125 ns at 160 MHz. A 74HC595 at 3.3 V needs about 50 ns; long wires need more.
constexpr std::uint32_t kHalfClockCycles = 20;

void drive(const Pin& pin, bool is_high) {
    pin.set(is_high);
    cpu::spin(kHalfClockCycles);
}

void pulse(const Pin& pin) {
    drive(pin, true);
    drive(pin, false);
}

}  // namespace

void XshutChain::start() {
    kOutputsOff.set(true);
    kOutputsOff.make_output(Drive::push_pull);
    for (const Pin& pin : {kData, kShift, kShow}) {
        pin.set(false);
        pin.make_output(Drive::push_pull, Speed::medium);
    }
    levels_ = 0;
    shift_out();
    kOutputsOff.set(false);
}

void XshutChain::set(std::uint8_t line, bool is_high) {
    assert(line < kLines);
    const std::uint64_t bit = std::uint64_t{1} << line;
    const std::uint64_t levels = is_high ? levels_ | bit : levels_ & ~bit;
    if (levels == levels_) return;  // at bring-up every sensor requests the reset that it is already in
    levels_ = levels;
    shift_out();
}

/// The first bit shifted ends in the last register: line 39 is shifted first, line 0 is output A of the first
/// register.
void XshutChain::shift_out() const {
    for (std::uint32_t line = kLines; line > 0; --line) {
        drive(kData, ((levels_ >> (line - 1)) & 1U) != 0);
        pulse(kShift);
    }
    pulse(kShow);
}

}  // namespace octoskin::stm32g4
