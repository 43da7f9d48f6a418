// The node on a NUCLEO-G474RE: builds the parts, wires them, loops.
#include "firmware/core/time_bracket.hpp"
#include "firmware/port/stm32g4/clocks.hpp"
#include "firmware/port/stm32g4/cpu.hpp"
#include "firmware/port/stm32g4/fault_handlers.hpp"
#include "firmware/port/stm32g4/interrupt_handlers.hpp"
#include "firmware/port/stm32g4/microsecond_timer.hpp"
#include "firmware/port/stm32g4/pin.hpp"
#include "firmware/port/stm32g4/reset_cause.hpp"
#include "firmware/port/stm32g4/serial_port.hpp"
#include "firmware/port/stm32g4/status_light.hpp"
#include "firmware/port/stm32g4/text_line.hpp"
#include "firmware/port/stm32g4/watchdog.hpp"

namespace octoskin::stm32g4 {
namespace {

constinit MicrosecondTimer timer;
constinit SerialPort serial;
constinit StatusLight light;

void say_hello(const Clocks& clocks, std::uint32_t reset_flags) {
    TextLine line;
    line.text("octoskin node, clock ").number(clocks.core_hz);
    if (clocks.source != ClockSource::crystal) line.text(" without the crystal: CAN is silent");
    line.text(", reset flags ").hex(reset_flags >> 24U, 2);
    serial.say(line.view());
}

[[noreturn]] void run() {
    start_watchdog();
    const Clocks clocks = start_clocks(timer);
    const std::uint32_t reset_flags = take_reset_flags();
    cpu::enable(Interrupt::tim2, cpu::Priority::text);
    enable_pins();
    light.start();
    if (clocks.source != ClockSource::crystal) light.show(Flashes::no_crystal);
    serial.start(clocks.core_hz);
    say_hello(clocks, reset_flags);
    while (true) {
        refresh_watchdog();
        const NodeTime wake = light.poll(timer.now());
        timer.wake_at(node::earlier_of(wake, timer.now() + Microseconds{50'000}));
        cpu::wait_for_interrupt();
    }
}

}  // namespace
}  // namespace octoskin::stm32g4

extern "C" {
void application() {
    octoskin::stm32g4::run();
}
void timer_interrupt() {
    octoskin::stm32g4::timer.on_interrupt();
}
void serial_interrupt() {
    octoskin::stm32g4::serial.on_interrupt();
}
void can_interrupt() {}
void i2c1_interrupt() {}
void i2c2_interrupt() {}
void i2c3_interrupt() {}
void i2c4_interrupt() {}
}

int main() {
    octoskin::stm32g4::run();
}
