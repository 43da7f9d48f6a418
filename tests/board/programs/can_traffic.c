// CAN as a program drives it: frames out, frames in through filters, bus-off and back.
#include "tiny.h"

#define RCC 0x40021000
#define CAN 0x40006400
#define CCCR REG(CAN + 0x18)
#define RAM 0x4000A400

static void wait(uint32_t turns) { for (volatile uint32_t i = 0; i < turns; ++i) {} }

static void start(void) {
    for (int i = 0; i < 64; ++i) result[i] = 0;
    REG(RCC + 0x58) |= 1u << 28 | 1u << 25;
    (void)REG(RCC + 0x58);
    REG(0x40007080) = 0;
    REG(RCC) |= 1u << 16;
    while (!(REG(RCC) & 1u << 17)) {}
    REG(RCC + 0x0C) = 0x01305053;
    REG(RCC) |= 1u << 24;
    while (!(REG(RCC) & 1u << 25)) {}
    REG(RCC + 0x88) = 1u << 24;
    REG(RCC + 0x4C) |= 1;
    (void)REG(RCC + 0x4C);
    REG(0x48000024) = (REG(0x48000024) & ~(0xFFu << 12)) | 0x99u << 12;
    REG(0x48000000) = (REG(0x48000000) & ~(15u << 22)) | 10u << 22;
    CCCR |= 1;
    while (!(CCCR & 1)) {}
    CCCR |= 2;
    REG(CAN + 0x1C) = 15u << 25 | 62u << 8 | 15;
    REG(CAN + 0x0C) = 1u << 23 | 10u << 8 | 3u << 4 | 3;
    REG(CAN + 0x48) = 12u << 8;
    CCCR |= 3u << 8;
    for (uint32_t i = 0; i < 0x350; i += 4) REG(RAM + i) = 0;
    REG(RAM + 0) = 2u << 30 | 1u << 27 | 0x120u << 16 | 0x7F0;  // 0x120..0x12F to FIFO 0
    REG(RAM + 4) = 1u << 30 | 2u << 27 | 0x200u << 16 | 0x201;  // 0x200, 0x201 to FIFO 1
    REG(RAM + 8) = 0u << 30 | 3u << 27 | 0x300u << 16 | 0x30F;  // 0x300..0x30F refused
    REG(CAN + 0x80) = 3u << 16 | 2u << 2 | 2u << 4 | 1;         // others refused, extended remote too
    REG(CAN + 0xDC) = 7;
    CCCR &= ~1u;
    while (CCCR & 1) {}
    wait(500);
}
static void put(uint32_t id, uint32_t format, uint32_t words) {
    const uint32_t at = REG(CAN + 0xC4) >> 16 & 3;
    const uint32_t element = RAM + 0x278 + 72 * at;
    REG(element) = id << 18;
    REG(element + 4) = format;
    for (uint32_t i = 0; i < words; ++i) REG(element + 8 + 4 * i) = 0x03020100 + 0x04040404 * i;
    REG(CAN + 0xCC) = 1u << at;
}

void transmit(void) {
    start();
    put(0x321, 8u << 16, 2);                             // classical, 8 bytes
    put(0x123, 1u << 21 | 1u << 20 | 15u << 16, 16);     // FD, fast, 64 bytes
    put(0x222, 1u << 21 | 9u << 16, 3);                  // FD, 12 bytes
    result[0] = REG(CAN + 0xC4);                         // full
    while (REG(CAN + 0xC8)) {}
    result[1] = REG(CAN + 0xD4);
    result[2] = REG(CAN + 0x50) >> 7 & 1;
    result[3] = REG(CAN + 0xC4);
    finish();
}
void transmit_by_identifier(void) {
    start();
    CCCR |= 1;
    while (!(CCCR & 1)) {}
    CCCR |= 2;
    REG(CAN + 0xC0) = 1u << 24;
    CCCR &= ~1u;
    while (CCCR & 1) {}
    wait(500);
    put(0x321, 8u << 16, 2);
    wait(100);           // it is on the wire
    put(0x222, 8u << 16, 2);
    put(0x123, 8u << 16, 2);
    result[0] = REG(CAN + 0xC4);  // full
    while (REG(CAN + 0xC8) & 1) {}
    result[1] = REG(CAN + 0xC4);  // the lowest free place is the first
    put(0x045, 8u << 16, 2);      // overtakes what is not on the wire yet
    while (REG(CAN + 0xC8)) {}
    finish();
}
void receive(void) {
    start();
    is_finished = 2;
    while ((REG(CAN + 0x90) & 15) < 3 || !(REG(CAN + 0x98) & 15)) {}
    wait(20000);
    result[0] = REG(CAN + 0x90);
    for (int i = 0; i < 3; ++i) {
        const uint32_t at = REG(CAN + 0x90) >> 8 & 3;
        const uint32_t element = RAM + 0xB0 + 72 * at;
        result[1 + 3 * i] = REG(element) >> 18;
        result[2 + 3 * i] = REG(element + 4) >> 16;
        result[3 + 3 * i] = REG(element + 8);
        REG(CAN + 0x94) = at;
    }
    result[10] = REG(RAM + 0x188) >> 18;
    result[11] = REG(CAN + 0x50) & 0xFF;
    result[12] = REG(CAN + 0x90) & 15;
    finish();
}
// The frame stays pending, the node becomes error-passive, never bus-off; cancelling ends it.
void alone(void) {
    start();
    put(0x321, 8u << 16, 2);
    wait(200000);
    result[0] = REG(CAN + 0x44) & 0xE0;  // EP, EW, BO
    result[1] = REG(CAN + 0x40) & 0xFF;
    result[2] = REG(CAN + 0xC8);
    REG(CAN + 0xD0) = 7;
    wait(100);
    result[3] = REG(CAN + 0xC8);
    result[4] = REG(CAN + 0xDC - 4);  // TXBCF
    finish();
}
// Bus-off sets INIT; clearing it brings the controller back after 129 times 11 bits.
void bus_off(void) {
    start();
    put(0x321, 8u << 16, 2);
    while (!(REG(CAN + 0x44) & 1u << 7)) {}
    result[0] = CCCR & 1;
    result[1] = REG(CAN + 0x50) >> 19 & 1;
    REG(CAN + 0x50) = ~0u >> 8;
    REG(CAN + 0xD0) = 7;
    is_finished = 2;  // the test mends the bus now
    wait(20000);
    is_finished = 3;
    CCCR &= ~1u;
    while (REG(CAN + 0x44) & 1u << 7) {}
    result[2] = REG(CAN + 0x40) & 0xFF;
    result[3] = REG(CAN + 0x50) >> 19 & 1;
    put(0x100, 1u << 16, 1);
    while (REG(CAN + 0xC8)) {}
    finish();
}
// Bus monitoring with the data rate of another bus: classical frames are heard, fast ones are errors, nothing is sent.
void overhear(void) {
    start();
    CCCR |= 1;
    while (!(CCCR & 1)) {}
    CCCR |= 2;
    CCCR |= 1u << 5;
    REG(CAN + 0x0C) = 1u << 23 | 28u << 8 | 9u << 4 | 9;  // 2 Mbit/s
    REG(CAN + 0x48) = 30u << 8;
    REG(CAN + 0x80) = 2u << 2;  // every standard frame to FIFO 0
    CCCR &= ~1u;
    while (CCCR & 1) {}
    wait(500);
    is_finished = 2;
    while (!(REG(CAN + 0x50) & 1u << 22)) {}
    result[0] = REG(CAN + 0x50) & 0x600001;  // PED, PEA, RF0N
    result[1] = REG(CAN + 0x90) & 15;
    result[2] = REG(RAM + 0xB0) >> 18;
    result[3] = REG(CAN + 0x40) & 0x7FFF;  // error counters
    put(0x321, 8u << 16, 2);
    wait(20000);
    result[4] = REG(CAN + 0xC8);
    finish();
}
