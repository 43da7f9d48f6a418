// Programs that tell, in result[], in which order exceptions ran and what they left of the interrupted state.
#include "tiny.h"

#define NVIC_ISER0 REG(0xE000E100)
#define NVIC_ISPR0 REG(0xE000E200)
#define NVIC_IPR(irq) REG8(0xE000E400 + (irq))
#define ICSR REG(0xE000ED04)
#define SHPR3 REG(0xE000ED20)
#define SHCSR REG(0xE000ED24)
#define CFSR REG(0xE000ED28)
#define HFSR REG(0xE000ED2C)
#define BFAR REG(0xE000ED38)
#define CPACR REG(0xE000ED88)
#define SYST_CSR REG(0xE000E010)
#define SYST_RVR REG(0xE000E014)
#define SYST_CVR REG(0xE000E018)

static volatile uint32_t position;
static volatile uint32_t ticks;
static volatile uint32_t mode;  // what the handlers do
enum { kPlain, kNestingB, kFloating, kFault, kMasking };

static void note(uint32_t what) { result[position++] = what; }
static void start(uint32_t new_mode) {
    position = 0;
    ticks = 0;
    mode = new_mode;
    for (int i = 0; i < 64; ++i) result[i] = 0;
    is_finished = 0;
}
static void enable_fpu(void) {
    CPACR |= 0xFu << 20;
    __asm volatile("dsb\n isb");
}
static void enable(uint32_t irq, uint32_t priority) {
    NVIC_IPR(irq) = (uint8_t)(priority << 4);
    NVIC_ISER0 = 1u << irq;
}
static void pend(uint32_t irq) {
    NVIC_ISPR0 = 1u << irq;
    __asm volatile("dsb\n isb");
}

static volatile float scratch;
static void use_fpu(float value) {
    __asm volatile("vmov s0, %0\n vmov s15, %0\n vadd.f32 s1, s0, s0\n" ::"r"(value) : "s0", "s1", "s15");
}

void irq_a(void) {
    note(0xA0);
    if (mode == kFloating) use_fpu(100.0f);
    if (mode == kNestingB) pend(1);
    if (mode == kFloating) pend(1);
    if (mode == kMasking) __asm volatile("cpsid f");
    note(0xA1);
}
void irq_b(void) {
    note(0xB0);
    if (mode == kNestingB) pend(2);
    if (mode == kFloating) use_fpu(200.0f);
    note(0xB1);
}
void irq_c(void) { note(0xC0); }
void pend_sv(void) { note(0xE0); }
void sv_call(void) { note(0x50); }
void sys_tick(void) { ++ticks; }

// A fresh stack first: the old one may be what failed.
__attribute__((naked)) void hard_fault(void) {
    __asm volatile("ldr sp, =0x20001000\n b record_hard_fault");
}
__attribute__((used)) void record_hard_fault(void) {
    note(0xF0);
    note(HFSR);
    note(CFSR);
    note(BFAR);
    finish();
}
void bus_fault(void) {
    note(0xF5);
    note(CFSR);
    note(BFAR);
    finish();
}
void usage_fault(void) {
    note(0xF6);
    note(CFSR);
    finish();
}

// B (1) preempts A (4); C (1) waits for B's end although it was pended within it; then A ends.
void nested(void) {
    start(kNestingB);
    enable(0, 4);
    enable(1, 1);
    enable(2, 1);
    pend(0);
    note(0x11);
    finish();
}

// PRIGROUP 5: only bits 7:6 of a priority preempt. B's 0x50 does not preempt A's 0x70, but goes first.
void grouped(void) {
    start(kNestingB);
    REG(0xE000ED0C) = 0x05FA0000 | 5u << 8;
    NVIC_IPR(0) = 0x70;
    NVIC_IPR(1) = 0x50;
    NVIC_IPR(2) = 0x10;
    NVIC_ISER0 = 7;
    pend(0);
    note(0x11);
    finish();
}

// FP registers and flags survive two levels of handlers that use the FPU themselves.
void floating(void) {
    start(kFloating);
    enable_fpu();
    enable(0, 4);
    enable(1, 1);
    uint32_t s0, s1, s15, fpscr_before, fpscr_after;
    __asm volatile("vmov.f32 s0, #1.5\n vmov.f32 s1, #2.5\n vmov.f32 s15, #7.0\n"
                   "vcmp.f32 s0, s1\n vmrs %3, fpscr\n"
                   "mov r3, #1\n str r3, [%5]\n dsb\n isb\n"
                   "vmrs %4, fpscr\n vmov %0, s0\n vmov %1, s1\n vmov %2, s15\n"
                   : "=&r"(s0), "=&r"(s1), "=&r"(s15), "=&r"(fpscr_before), "=&r"(fpscr_after)
                   : "r"(0xE000E200)
                   : "r3", "s0", "s1", "s15", "memory", "cc");
    note(s0);
    note(s1);
    note(s15);
    note(fpscr_before == fpscr_after);
    finish();
}

// Registers, flags, GE bits and IT state survive an interrupt in the middle of an IT block; 10,000 times with
// SysTick at odd moments.
void it_block(void) {
    start(kPlain);
    enable_fpu();
    SYST_RVR = 36;
    SYST_CVR = 0;
    SYST_CSR = 7;
    uint32_t wrong = 0;
    for (uint32_t i = 0; i < 10000; ++i) {
        uint32_t a = i, b, c = 0, ge;
        __asm volatile("cmp %1, #0\n"
                       "ite ge\n addge %0, %1, #5\n sublt %0, %1, #5\n"
                       "uadd8 r3, %1, %1\n"
                       "tst %1, #1\n"
                       "itete eq\n moveq %2, #10\n movne %2, #20\n addeq %2, %2, #1\n addne %2, %2, #2\n"
                       "mrs %3, apsr\n"
                       : "=&r"(b), "+r"(a), "+r"(c), "=&r"(ge)
                       :
                       : "r3", "cc");
        if (b != i + 5 || c != ((i & 1) ? 22u : 11u) || a != i) ++wrong;
    }
    SYST_CSR = 0;
    note(wrong);
    note(ticks > 1000);
    finish();
}

// PRIMASK holds A back until it is cleared.
void primask(void) {
    start(kPlain);
    enable(0, 4);
    __asm volatile("cpsid i");
    pend(0);
    note(0x11);
    __asm volatile("cpsie i\n isb");
    note(0x12);
    finish();
}

// BASEPRI 0x40 holds A (4) back, not B (3).
void basepri(void) {
    start(kPlain);
    enable(0, 4);
    enable(1, 3);
    __asm volatile("msr basepri, %0\n isb" ::"r"(0x40));
    pend(0);
    pend(1);
    note(0x11);
    __asm volatile("msr basepri, %0\n isb" ::"r"(0));
    note(0x12);
    finish();
}

// FAULTMASK holds back everything but NMI.
void faultmask(void) {
    start(kPlain);
    enable(1, 0);
    __asm volatile("cpsid f");
    pend(1);
    note(0x11);
    __asm volatile("cpsie f\n isb");
    note(0x12);
    finish();
}

// A handler that sets FAULTMASK: its return clears it (ARMv7-M ARM B1.4.3).
void faultmask_in_handler(void) {
    start(kMasking);
    enable(0, 4);
    enable(1, 4);
    pend(0);
    note(0x11);
    pend(1);
    note(0x12);
    finish();
}

// WFI wakes with PRIMASK set, and the handler runs only when it is cleared.
void wfi_masked(void) {
    start(kPlain);
    SHPR3 = 0x20u << 24;
    SYST_RVR = 15999;
    SYST_CVR = 0;
    __asm volatile("cpsid i");
    SYST_CSR = 7;
    __asm volatile("wfi");
    note(ticks);
    note(ICSR >> 26 & 1);
    __asm volatile("cpsie i\n isb");
    note(ticks);
    finish();
}

// WFI in thread mode; the handler runs, then the program goes on behind it. WFE and YIELD do nothing.
void wfi_plain(void) {
    start(kPlain);
    __asm volatile("yield\n wfe\n sev");
    SYST_RVR = 15999;
    SYST_CVR = 0;
    SYST_CSR = 7;
    for (int i = 0; i < 5; ++i) __asm volatile("wfi");
    note(ticks);
    finish();
}

// SVC, PendSV at the lowest priority, tail-chained.
void system_calls(void) {
    start(kPlain);
    SHPR3 = 0xF0u << 16;
    enable(0, 4);
    __asm volatile("svc #3");
    note(0x11);
    __asm volatile("cpsid i");
    ICSR = 1u << 28;
    NVIC_ISPR0 = 1;
    __asm volatile("cpsie i\n isb");
    note(0x12);
    finish();
}

// SP at 4 modulo 8 at the time of the exception comes back as it was.
void stack_alignment(void) {
    start(kPlain);
    enable(0, 4);
    uint32_t before, after;
    __asm volatile("sub sp, #4\n mov %0, sp\n mov r3, #1\n str r3, [%2]\n dsb\n isb\n mov %1, sp\n add sp, #4\n"
                   : "=&r"(before), "=&r"(after)
                   : "r"(0xE000E200)
                   : "r3", "memory");
    note(before & 7);
    note(before == after);
    finish();
}

void fault_disabled(void) {
    start(kFault);
    (void)REG(0x30000010);
    finish();
}
void fault_enabled(void) {
    start(kFault);
    SHCSR = 7u << 16;
    REG(0x30000010) = 1;
    finish();
}
void fault_null_call(void) {
    start(kFault);
    ((void (*)(void))1)();
    finish();
}
void fault_undefined(void) {
    start(kFault);
    SHCSR = 7u << 16;
    __asm volatile("udf #0");
    finish();
}
void fault_flash_write(void) {
    start(kFault);
    REG(0x08000100) = 1;
    finish();
}
void fpu_while_disabled(void) {
    start(kPlain);
    use_fpu(1.0f);
    finish();
}

// The stack overflows into unmapped memory: HardFault without a frame; it sets a fresh stack first.
static __attribute__((noinline)) uint32_t recurse(uint32_t depth) {
    volatile uint32_t filler[64];
    filler[depth % 64] = depth;
    return recurse(depth + 1) + filler[(depth + 1) % 64];
}
void stack_overflow(void) {
    start(kFault);
    result[0] = recurse(0);
    finish();
}

// Ends with the watchdog or never.
void fault_in_hard_fault(void) {
    start(kPlain);
    __asm volatile("cpsid f");
    (void)REG(0x30000010);
    finish();
}

// A million turns of a loop of four instructions: how time and instructions are counted.
void count_cycles(void) {
    start(kPlain);
    REG(0xE000EDFC) |= 1u << 24;
    REG(0xE0001004) = 0;
    REG(0xE0001000) |= 1;
    uint32_t turns = 1000000;
    __asm volatile("1: subs %0, #1\n nop\n nop\n bne 1b" : "+r"(turns) : : "cc");
    note(REG(0xE0001004));
    finish();
}
