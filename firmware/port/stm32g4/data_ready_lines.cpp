#include "firmware/port/stm32g4/data_ready_lines.hpp"

#include "common/config/node_config.hpp"
#include "firmware/port/stm32g4/cpu.hpp"
#include "firmware/port/stm32g4/pin.hpp"
#include "firmware/port/stm32g4/registers/clocks_and_power.hpp"
#include "firmware/port/stm32g4/registers/external_interrupts.hpp"

namespace octoskin::stm32g4 {

namespace {

constexpr std::uint8_t kFirstLine = 12;  // line of bus 0; the line number is the pin number
constexpr std::uint32_t kPortB = 1;      // EXTICR4
constexpr std::uint32_t kLines = 0xFU << kFirstLine;

}  // namespace

void DataReadyLines::start(std::uint8_t buses) {
    if (buses == 0) return;
    rcc.set("APB2ENR.SYSCFGEN", 1);
    (void)rcc.read("APB2ENR");
    for (std::uint8_t bus = 0; bus < kNodeBusesMax; ++bus) {
        if (((unsigned{buses} >> bus) & 1U) == 0) continue;
        const auto line = static_cast<std::uint8_t>(kFirstLine + bus);
        Pin(gpio_b, line).make_input(Pull::up);
        syscfg.set(Field<SyscfgMap>("EXTICR4.EXTI#")[bus], kPortB);
        exti.set(Field<ExtiMap>("FTSR1.FT#")[line], 1);
    }
    const std::uint32_t lines = std::uint32_t{buses} << kFirstLine;
    exti.write("PR1", lines);
    exti.write("IMR1", exti.read("IMR1") | lines);
    cpu::enable(Interrupt::exti10_to_15, cpu::Priority::text);
}

bool DataReadyLines::take_fall(std::uint8_t bus) {
    const std::uint32_t bit = 1U << bus;
    if ((fallen_ & bit) == 0) return false;
    const cpu::MaskedSection masked;
    fallen_ = fallen_ & ~bit;
    // It depends on the chip whether an edge since then is pending: clear it.
    exti.write("PR1", bit << kFirstLine);
    exti.write("IMR1", exti.read("IMR1") | bit << kFirstLine);
    return true;
}

void DataReadyLines::on_interrupt() {
    const std::uint32_t listening = exti.read("IMR1");
    const std::uint32_t fallen = exti.read("PR1") & listening & kLines;
    exti.write("IMR1", listening & ~fallen);
    exti.write("PR1", fallen);
    fallen_ = fallen_ | fallen >> kFirstLine;
    has_event_ = true;
}

}  // namespace octoskin::stm32g4
