// What the tiny programs share: register access, a vector table of weak handlers, results in RAM. RAM is not
// initialised: programs write before they read.
#pragma once
#include <stdint.h>

#define REG(address) (*(volatile uint32_t*)(address))
#define REG8(address) (*(volatile uint8_t*)(address))
#define REG16(address) (*(volatile uint16_t*)(address))

extern volatile uint32_t result[64];
extern volatile uint32_t is_finished;

// The end of every program: the test looks for it.
static inline __attribute__((noreturn)) void finish(void) {
    is_finished = 1;
    for (;;) __asm volatile("nop");
}
