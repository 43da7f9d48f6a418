#include "tiny.h"

volatile uint32_t result[64];
volatile uint32_t is_finished;

__attribute__((weak)) void reset(void) { for (;;) __asm volatile("wfi"); }
__attribute__((noreturn)) static void unexpected(void) {
    result[63] = 0xDEAD;
    finish();
}

#define HANDLER(name) __attribute__((weak, alias("unexpected_handler"))) void name(void);
void unexpected_handler(void) { unexpected(); }
HANDLER(nmi) HANDLER(hard_fault) HANDLER(mem_manage) HANDLER(bus_fault) HANDLER(usage_fault) HANDLER(sv_call)
HANDLER(pend_sv) HANDLER(sys_tick) HANDLER(irq_a) HANDLER(irq_b) HANDLER(irq_c) HANDLER(irq_i2c1_ev)
HANDLER(irq_i2c1_er) HANDLER(irq_fdcan1_0) HANDLER(irq_tim2) HANDLER(irq_exti15_10)

// Interrupts 0, 1 and 2 (never raised by hardware here) are A, B and C.
__attribute__((section(".vectors"), used)) void (*const vectors[16 + 102])(void) = {
    (void (*)(void))0x20001000, reset, nmi, hard_fault, mem_manage, bus_fault, usage_fault, 0, 0, 0, 0, sv_call, 0, 0,
    pend_sv, sys_tick,
    [16 + 0] = irq_a, [16 + 1] = irq_b, [16 + 2] = irq_c,
    [16 + 40] = irq_exti15_10,
    [16 + 21] = irq_fdcan1_0, [16 + 28] = irq_tim2, [16 + 31] = irq_i2c1_ev, [16 + 32] = irq_i2c1_er,
};
