// Instructions without a C++ equivalent, and the interrupt controller. On the PC the tests link their own
// versions.
#pragma once

#include <cstdint>

#include "firmware/port/stm32g4/registers/core.hpp"
#include "firmware/port/stm32g4/registers/interrupts.hpp"

namespace octoskin::stm32g4::cpu {

#if defined(__arm__)
inline void mask_interrupts() {
    __asm volatile("cpsid i" ::: "memory");
}
/// Pending interrupts are handled before the next instruction.
inline void unmask_interrupts() {
    __asm volatile("cpsie i\n\tisb" ::: "memory");
}
/// Sleeps until an interrupt is pending, masked or not.
inline void wait_for_interrupt() {
    __asm volatile("dsb\n\twfi" ::: "memory");
}
/// Completes all stores before any later access.
inline void barrier() {
    __asm volatile("dsb\n\tisb" ::: "memory");
}
/// Takes at least `cycles`: one iteration takes three, the branch alone at least two.
inline void spin(std::uint32_t cycles) {
    for (std::uint32_t turns = cycles / 3 + 1; turns > 0; --turns) __asm volatile("");
}
#else
void mask_interrupts();
void unmask_interrupts();
void wait_for_interrupt();
void barrier();
void spin(std::uint32_t cycles);
#endif

/// 0 is the highest priority. This M4 has 16 levels, in the upper 4 bits of a byte.
enum class Priority : std::uint8_t { stamp = 0, transfer = 1, text = 2 };

inline void enable(Interrupt interrupt, Priority priority) {
    const auto number = static_cast<std::uint32_t>(interrupt);
    const auto level = Field<NvicMap>("IPR#.IPR_N#").in_register(number / 4)[number % 4];
    nvic.set(level, static_cast<std::uint32_t>(priority) << 4U);
    nvic.write(Register<NvicMap>("ISER#")[number / 32], 1U << (number % 32));
}

inline void disable(Interrupt interrupt) {
    const auto number = static_cast<std::uint32_t>(interrupt);
    nvic.write(Register<NvicMap>("ICER#")[number / 32], 1U << (number % 32));
    barrier();
}

/// Masks all interrupts for its lifetime. Must not be nested.
class MaskedSection {
  public:
    MaskedSection() { mask_interrupts(); }
    ~MaskedSection() { unmask_interrupts(); }
    MaskedSection(const MaskedSection&) = delete;
    MaskedSection& operator=(const MaskedSection&) = delete;
};

/// Resets the chip after pending stores are complete.
[[noreturn]] inline void reset() {
    constexpr std::uint32_t kKey = 0x05FA;  // ARMv7-M: AIRCR ignores writes without it
    barrier();
    scb.write("AIRCR", Field<ScbMap>("AIRCR.VECTKEYSTAT")(kKey) | Field<ScbMap>("AIRCR.SYSRESETREQ")(1));
    barrier();
    while (true) spin(1);
}

}  // namespace octoskin::stm32g4::cpu
