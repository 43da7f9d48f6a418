// From reset to the application: vector table, FPU, memory. Code here must not use initialised data before
// `prepare_memory`.
#include <array>
#include <cstdint>

#include "firmware/port/stm32g4/cpu.hpp"
#include "firmware/port/stm32g4/interrupt_handlers.hpp"
#include "firmware/port/stm32g4/registers/core.hpp"

extern "C" {
// From the linker script. Only the addresses of these symbols matter, except for the data that they delimit.
extern const std::uint32_t data_source[];
extern std::uint32_t data_begin[];
extern std::uint32_t data_end[];
extern std::uint32_t bss_begin[];
extern std::uint32_t bss_end[];
extern std::uint32_t stack_top[];

[[noreturn]] void reset_handler();
}

namespace octoskin::stm32g4 {
namespace {

using Handler = void (*)();

struct VectorTable {
    std::uint32_t* initial_stack;
    std::array<Handler, kExceptionCount - 1> exceptions;
    std::array<Handler, kInterruptCount> interrupts;
};

constexpr std::array<Handler, kExceptionCount - 1> exception_handlers() {
    std::array<Handler, kExceptionCount - 1> handlers{};
    handlers.fill(&unexpected_interrupt);
    handlers[0] = &reset_handler;
    handlers[1] = &nmi_handler;
    handlers[2] = &fault_handler;  // hard fault
    handlers[3] = &fault_handler;  // memory management, bus, usage: not enabled, so they become hard faults
    handlers[4] = &fault_handler;
    handlers[5] = &fault_handler;
    return handlers;
}

constexpr std::array<Handler, kInterruptCount> interrupt_handlers() {
    std::array<Handler, kInterruptCount> handlers{};
    handlers.fill(&unexpected_interrupt);
    const auto set = [&handlers](Interrupt interrupt, Handler handler) {
        handlers[static_cast<std::size_t>(interrupt)] = handler;
    };
    set(Interrupt::fdcan1_it0, &can_interrupt);
    set(Interrupt::tim2, &timer_interrupt);
    set(Interrupt::i2c1_event, &i2c1_interrupt);
    set(Interrupt::i2c1_error, &i2c1_interrupt);
    set(Interrupt::i2c2_event, &i2c2_interrupt);
    set(Interrupt::i2c2_error, &i2c2_interrupt);
    set(Interrupt::i2c3_event, &i2c3_interrupt);
    set(Interrupt::i2c3_error, &i2c3_interrupt);
    set(Interrupt::i2c4_event, &i2c4_interrupt);
    set(Interrupt::i2c4_error, &i2c4_interrupt);
    set(Interrupt::exti10_to_15, &data_ready_interrupt);
    set(Interrupt::lpuart1, &serial_interrupt);
    return handlers;
}

[[gnu::section(".vectors"), gnu::used]] constinit const VectorTable vector_table = {
    .initial_stack = stack_top, .exceptions = exception_handlers(), .interrupts = interrupt_handlers()};

void enable_fpu() {
    constexpr std::uint32_t kFullAccess = 0xF;  // coprocessors 10 and 11
    cpacr.set("CPACR.CP", kFullAccess);
    // No lazy stacking of the FPU registers: Cortex-M4 erratum 776924.
    fpu.write("FPCCR", Field<FpuMap>("FPCCR.ASPEN")(1));
    cpu::barrier();
}

void prepare_memory() {
    const std::uint32_t* source = data_source;
    for (std::uint32_t* to = data_begin; to < data_end; ++to) *to = *source++;
    for (std::uint32_t* to = bss_begin; to < bss_end; ++to) *to = 0;
}

}  // namespace
}  // namespace octoskin::stm32g4

extern "C" void reset_handler() {
    using namespace octoskin::stm32g4;
    enable_fpu();
    scb.write("VTOR", static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(&vector_table)));
    scb.set("CCR.DIV_0_TRP", 1);
    prepare_memory();
    application();
}
