// I2C1 as a program drives it, by polling: what each kind of end looks like.
#include "tiny.h"

#define RCC 0x40021000
#define GPIOA 0x48000000
#define GPIOB 0x48000400
#define I2C 0x40005400
#define CR1 REG(I2C + 0x00)
#define CR2 REG(I2C + 0x04)
#define ISR REG(I2C + 0x18)
#define ICR REG(I2C + 0x1C)

static void start(void) {
    for (int i = 0; i < 64; ++i) result[i] = 0;
    REG(RCC + 0x4C) |= 3;
    REG(RCC + 0x58) |= 1u << 21;
    (void)REG(RCC + 0x58);
    REG(GPIOA + 0x04) |= 1u << 15;
    REG(GPIOA + 0x24) = (REG(GPIOA + 0x24) & ~(15u << 28)) | 4u << 28;
    REG(GPIOA + 0x00) = (REG(GPIOA + 0x00) & ~(3u << 30)) | 2u << 30;
    REG(GPIOB + 0x04) |= 1u << 7;
    REG(GPIOB + 0x20) = (REG(GPIOB + 0x20) & ~(15u << 28)) | 4u << 28;
    REG(GPIOB + 0x00) = (REG(GPIOB + 0x00) & ~(3u << 14)) | 2u << 14;
    REG(I2C + 0x10) = 0x00611011;
    CR1 = 1;
}
// Writes index 0x0102, reads `count` bytes. Returns the flags that ended it; result[at...] gets the bytes.
static uint32_t transfer(uint32_t address, uint32_t count, int at) {
    uint32_t written = 0, received = 0;
    REG(I2C + 0x28) = 0x01;
    CR2 = address << 1 | 2u << 16 | 1u << 13;
    for (uint32_t i = 0; i < 100000; ++i) {
        const uint32_t flags = ISR;
        if (flags & 1u << 9) return flags;                     // ARLO
        if (flags & 1u << 5) {                                 // STOPF
            ICR = 1u << 5 | 1u << 4;
            return flags | written << 24 | received << 28;
        }
        if (flags & 1u << 1) { REG(I2C + 0x28) = 0x02; ++written; }
        if (flags & 1u << 2) result[at + received++] = REG(I2C + 0x24);
        if (flags & 1u << 6) CR2 = address << 1 | count << 16 | 1u << 10 | 1u << 13 | 1u << 25;
    }
    return ISR | 1u << 31;  // no end
}
void good_then_good(void) {
    start();
    result[0] = transfer(0x42, 3, 1);
    result[4] = transfer(0x42, 2, 5);
    finish();
}
// After a refusal the byte that waits must be flushed, or it would be the next transfer's first.
void refused_then_good(void) {
    start();
    result[0] = transfer(0x42, 3, 1);
    result[8] = ISR & 1;
    ISR = 1;
    result[4] = transfer(0x42, 2, 5);
    finish();
}
// Nobody feeds the second byte: refused, the controller no longer asks for it.
void refused_unfed(void) {
    start();
    REG(I2C + 0x28) = 0x01;
    CR2 = 0x42u << 1 | 2u << 16 | 1u << 13;
    while (!(ISR & 1u << 4)) {}
    result[0] = ISR & 0x13;  // TXE, TXIS, NACKF
    finish();
}
void stretched(void) {
    start();
    result[0] = transfer(0x42, 3, 1);
    CR1 = 0;
    (void)CR1;
    CR1 = 1;
    result[4] = transfer(0x42, 2, 5);
    finish();
}
void arbitration(void) {
    start();
    result[0] = transfer(0x42, 3, 1);
    CR1 = 0;
    (void)CR1;
    CR1 = 1;
    result[4] = transfer(0x42, 2, 5);
    finish();
}
static void gpio_mode(uint32_t mode) {
    REG(GPIOA + 0x00) = (REG(GPIOA + 0x00) & ~(3u << 30)) | mode << 30;
    REG(GPIOB + 0x00) = (REG(GPIOB + 0x00) & ~(3u << 14)) | mode << 14;
}
// SDA is low: counts the clocks it takes, makes a STOP, and transfers.
static void free_and_transfer(void) {
    result[0] = ISR >> 15 & 1;
    CR1 = 0;
    (void)CR1;
    REG(GPIOA + 0x18) = 1u << 15;
    REG(GPIOB + 0x18) = 1u << 7;
    gpio_mode(1);
    uint32_t clocks = 0;
    while (!(REG(GPIOB + 0x10) & 1u << 7) && clocks < 20) {
        REG(GPIOA + 0x18) = 1u << 31;
        REG(GPIOA + 0x18) = 1u << 15;
        ++clocks;
    }
    result[1] = clocks;
    REG(GPIOA + 0x18) = 1u << 31;
    REG(GPIOB + 0x18) = 1u << 23;
    REG(GPIOA + 0x18) = 1u << 15;
    REG(GPIOB + 0x18) = 1u << 7;
    gpio_mode(2);
    CR1 = 1;
    result[4] = transfer(0x42, 2, 5);
    finish();
}
void stuck(void) {
    start();
    free_and_transfer();
}
// The controller is switched off in the middle of a byte of zeros that a target sends.
void abandoned(void) {
    start();
    CR2 = 0x42u << 1 | 3u << 16 | 1u << 10 | 1u << 13 | 1u << 25;
    while (!(ISR & 1u << 2)) {}
    (void)REG(I2C + 0x24);
    for (volatile int i = 0; i < 8; ++i) {}
    CR1 = 0;
    result[2] = REG(GPIOB + 0x10) >> 7 & 1;
    free_and_transfer();
}
