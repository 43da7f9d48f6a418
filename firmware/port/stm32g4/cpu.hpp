// The few instructions that C++ has no words for, and the interrupt controller. On the PC a test links its
// own.
#pragma once

#include <cstdint>

#include "firmware/port/stm32g4/registers/core.hpp"
#include "firmware/port/stm32g4/registers/interrupts.hpp"

namespace octoskin::stm32g4::cpu {

#if defined(__arm__)
inline void mask_interrupts() {
    __asm volatile("cpsid i" ::: "memory");
}
/// What is pending is handled before the next instruction.
inline void unmask_interrupts() {
    __asm volatile("cpsie i\n\tisb" ::: "memory");
}
/// Sleeps until an interrupt is pending, masked or not.
inline void wait_for_interrupt() {
    __asm volatile("dsb\n\twfi" ::: "memory");
}
/// What was stored before is seen by whoever looks after.
inline void barrier() {
    __asm volatile("dsb\n\tisb" ::: "memory");
}
/// At least this many cycles: a turn of the loop takes three, the branch alone two or more.
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

/// 0 goes first. The M4 of this part has 16 levels, in the upper 4 bits of a byte.
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

/// No interrupt handler runs while one of these lives. Not to be nested.
class MaskedSection {
  public:
    MaskedSection() { mask_interrupts(); }
    ~MaskedSection() { unmask_interrupts(); }
    MaskedSection(const MaskedSection&) = delete;
    MaskedSection& operator=(const MaskedSection&) = delete;
};

/// Never returns. Pending stores are done first.
[[noreturn]] inline void reset() {
    constexpr std::uint32_t kKey = 0x05FA;  // ARMv7-M: AIRCR ignores writes without it
    barrier();
    scb.write("AIRCR", Field<ScbMap>("AIRCR.VECTKEYSTAT")(kKey) | Field<ScbMap>("AIRCR.SYSRESETREQ")(1));
    barrier();
    while (true) spin(1);
}

}  // namespace octoskin::stm32g4::cpu
