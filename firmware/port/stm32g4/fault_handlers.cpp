#include "firmware/port/stm32g4/fault_handlers.hpp"

#include <atomic>
#include <cstdint>

#include "firmware/port/stm32g4/configuration_page.hpp"
#include "firmware/port/stm32g4/cpu.hpp"
#include "firmware/port/stm32g4/interrupt_handlers.hpp"
#include "firmware/port/stm32g4/registers/clocks_and_power.hpp"
#include "firmware/port/stm32g4/registers/core.hpp"
#include "firmware/port/stm32g4/registers/fdcan.hpp"
#include "firmware/port/stm32g4/registers/timer.hpp"

extern "C" {
extern std::uint32_t stack_bottom[];
extern std::uint32_t ram_end[];
}

namespace octoskin::stm32g4 {

namespace {

[[gnu::section(".noinit")]] FaultRecord the_record;
[[gnu::section(".noinit")]] node::KeptMemory the_kept_memory;
constinit std::atomic<bool> the_configuration_is_damaged = false;

/// Registers that the core pushes at an exception (ARMv7-M).
struct StackedFrame {
    std::uint32_t r0, r1, r2, r3, r12, lr, pc, xpsr;
};

/// Null if the stack pointer is outside RAM: then nothing was pushed.
const StackedFrame* frame_at(std::uintptr_t address) {
    const bool is_in_ram = address >= reinterpret_cast<std::uintptr_t>(stack_bottom) &&
                           address + sizeof(StackedFrame) <= reinterpret_cast<std::uintptr_t>(ram_end);
    // NOLINTNEXTLINE(performance-no-int-to-ptr): an address is all that the core gives.
    return is_in_ram ? reinterpret_cast<const StackedFrame*>(address) : nullptr;
}

/// The register is accessible only while CAN's clock is on.
void silence_can() {
    if (rcc.is_set("APB1ENR1.FDCANEN")) fdcan1.set("CCCR.INIT", 1);
}

/// Handles a double bit error in the configuration page: clears the flag and records it. False if the error
/// is elsewhere.
bool takes_damaged_configuration() {
    using F = Field<FlashMap>;
    const std::uint32_t error = flash.read("ECCR");
    if (F("ECCR.ECCD").of(error) == 0) return false;
    if (!is_in_configuration_page(F("ECCR.ADDR_ECC").of(error), F("ECCR.BK_ECC").of(error) != 0))
        return false;
    flash.write("ECCR", F("ECCR.ECCD")(1));  // cleared by writing 1
    the_configuration_is_damaged = true;
    return true;
}

NodeTime uptime() {
    return {rcc.is_set("APB1ENR1.TIM2EN") ? tim2.read("CNT") : 0};
}

}  // namespace

FaultRecord& fault_record() {
    return the_record;
}

node::KeptMemory& kept_memory() {
    return the_kept_memory;
}

bool is_configuration_damaged() {
    return the_configuration_is_damaged;
}

void record_and_reset(const Fault& fault) {
    cpu::mask_interrupts();
    silence_can();
    Fault timed = fault;
    timed.uptime = uptime();
    the_record.write(timed);
    node::note_fault(the_kept_memory, fault.kind, fault.where);
    cpu::reset();
}

}  // namespace octoskin::stm32g4

namespace {

using octoskin::wire::FaultKind;

[[noreturn]] void stop(const void* where) {
    octoskin::stm32g4::record_and_reset(
        {.kind = FaultKind::assertion,
         .where = static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(where))});
}

}  // namespace

extern "C" {

[[noreturn, gnu::used]] void record_core_fault(std::uintptr_t stack, std::uint32_t exception_return) {
    using namespace octoskin::stm32g4;
    using F = Field<ScbMap>;
    const StackedFrame* frame = frame_at(stack);
    Fault fault{.kind = frame != nullptr ? FaultKind::hard_fault : FaultKind::stack_guard,
                .where = frame != nullptr ? frame->pc : 0,
                .called_from = frame != nullptr ? frame->lr : exception_return,
                .status = scb.read("CFSR_UFSR_BFSR_MMFSR")};
    if (F("CFSR_UFSR_BFSR_MMFSR.BFARVALID").of(fault.status) != 0) fault.address = scb.read("BFAR");
    if (F("CFSR_UFSR_BFSR_MMFSR.MMARVALID").of(fault.status) != 0) fault.address = scb.read("MMFAR");
    record_and_reset(fault);
}

[[noreturn, gnu::used]] void record_unexpected_interrupt() {
    using namespace octoskin::stm32g4;
    record_and_reset({.kind = FaultKind::unknown, .where = scb.get("ICSR.VECTACTIVE")});
}

/// The NMI has two sources: the clock security system (the crystal failed), and a flash word with a double
/// bit error. In the configuration page this is no reason to stop, since the node can still report it. In the
/// program it is.
[[gnu::used]] void take_nmi(std::uintptr_t stack) {
    using namespace octoskin::stm32g4;
    const bool is_clock = rcc.is_set("CIFR.CSSF");
    if (!is_clock && takes_damaged_configuration()) return;
    silence_can();
    const StackedFrame* frame = frame_at(stack);
    record_and_reset({.kind = is_clock ? FaultKind::clock_fault : FaultKind::unknown,
                      .where = frame != nullptr ? frame->pc : 0,
                      .called_from = frame != nullptr ? frame->lr : 0});
}

// The fault may be a stack overflow, so each handler uses a separate stack. r0: the old stack pointer.
[[gnu::naked]] void fault_handler() {
    __asm volatile(
        "mrs r0, msp\n\t"
        "mov r1, lr\n\t"
        "ldr r2, =fault_stack_top\n\t"
        "msr msp, r2\n\t"
        "b record_core_fault\n\t"
        ".ltorg");
}

[[gnu::naked]] void nmi_handler() {
    __asm volatile(
        "mrs r0, msp\n\t"
        "ldr r2, =fault_stack_top\n\t"
        "msr msp, r2\n\t"
        "push {r0, lr}\n\t"
        "bl take_nmi\n\t"
        "pop {r0, lr}\n\t"
        "msr msp, r0\n\t"
        "bx lr\n\t"
        ".ltorg");
}

[[gnu::naked]] void unexpected_interrupt() {
    __asm volatile(
        "ldr r2, =fault_stack_top\n\t"
        "msr msp, r2\n\t"
        "b record_unexpected_interrupt\n\t"
        ".ltorg");
}

// Called by the C and C++ libraries when the program must not continue.
// NOLINTNEXTLINE(bugprone-reserved-identifier): newlib's name.
[[noreturn]] void __assert_func(const char*, int, const char*, const char*) {
    stop(__builtin_return_address(0));
}
[[gnu::noreturn]] void abort() {
    stop(__builtin_return_address(0));
}
// NOLINTNEXTLINE(bugprone-reserved-identifier): the C++ ABI's name.
[[noreturn]] void __cxa_pure_virtual() {
    stop(__builtin_return_address(0));
}
}
