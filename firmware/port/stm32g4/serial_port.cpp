#include "firmware/port/stm32g4/serial_port.hpp"

#include "firmware/port/stm32g4/cpu.hpp"
#include "firmware/port/stm32g4/pin.hpp"
#include "firmware/port/stm32g4/registers/clocks_and_power.hpp"
#include "firmware/port/stm32g4/registers/lpuart.hpp"

namespace octoskin::stm32g4 {

namespace {
constexpr Pin kTransmitPin{gpio_a, 2};
constexpr std::uint8_t kTransmitFunction = 12;  // datasheet DS12288, alternate functions
constexpr std::string_view kLineEnd = "\r\n";
}  // namespace

void SerialPort::start(std::uint32_t clock_hz) {
    using F = Field<LpuartMap>;
    rcc.set("APB1ENR2.LPUART1EN", 1);
    (void)rcc.read("APB1ENR2");
    kTransmitPin.make_alternate(kTransmitFunction, Drive::push_pull);
    lpuart1.write("CR1", 0);
    lpuart1.write("BRR", lpuart_divider(clock_hz));
    lpuart1.write("CR1", F("CR1.UE")(1) | F("CR1.TE")(1));
    cpu::enable(Interrupt::lpuart1, cpu::Priority::text);
}

bool SerialPort::say(std::string_view line) {
    if (line.size() + kLineEnd.size() > room()) {
        ++lost_count_;
        return false;
    }
    for (const char character : line) put(character);
    for (const char character : kLineEnd) put(character);
    // The handler may clear this bit between read and write: then there is one extra interrupt with nothing
    // to send.
    lpuart1.set("CR1.TXEIE", 1);
    return true;
}

void SerialPort::put(char character) {
    queue_[put_ % kQueueBytes] = character;
    put_ = put_ + 1;
}

void SerialPort::on_interrupt() {
    if (taken_ == put_) {
        lpuart1.set("CR1.TXEIE", 0);
    } else if (lpuart1.is_set("ISR.TXE")) {
        lpuart1.write("TDR", static_cast<std::uint8_t>(queue_[taken_ % kQueueBytes]));
        taken_ = taken_ + 1;
    }
}

}  // namespace octoskin::stm32g4
