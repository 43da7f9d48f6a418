// One function per rule: each does one thing that the manuals forbid, after doing everything else right.
#include "tiny.h"

#define RCC 0x40021000
#define RCC_CR REG(RCC + 0x00)
#define RCC_CFGR REG(RCC + 0x08)
#define RCC_PLLCFGR REG(RCC + 0x0C)
#define RCC_AHB2ENR REG(RCC + 0x4C)
#define RCC_APB1ENR1 REG(RCC + 0x58)
#define RCC_APB1ENR2 REG(RCC + 0x5C)
#define RCC_CCIPR REG(RCC + 0x88)
#define PWR_CR5 REG(0x40007080)
#define FLASH_ACR REG(0x40022000)
#define DBG_SWEN (1u << 18)
#define GPIOA 0x48000000
#define GPIOB 0x48000400
#define I2C1 0x40005400
#define I2C1_CR1 REG(I2C1 + 0x00)
#define I2C1_CR2 REG(I2C1 + 0x04)
#define I2C1_TIMINGR REG(I2C1 + 0x10)
#define I2C1_ISR REG(I2C1 + 0x18)
#define I2C1_RXDR REG(I2C1 + 0x24)
#define I2C1_TXDR REG(I2C1 + 0x28)
#define CAN 0x40006400
#define CCCR REG(CAN + 0x18)
#define NBTP REG(CAN + 0x1C)
#define DBTP REG(CAN + 0x0C)
#define TDCR REG(CAN + 0x48)
#define TXBAR REG(CAN + 0xCC)
#define RXF0A REG(CAN + 0x94)
#define SRAMCAN 0x4000A400
#define IWDG 0x40003000
#define LPUART 0x40008000
#define RCC_APB2ENR REG(RCC + 0x60)
#define EXTICR4 REG(0x40010014)
#define EXTI 0x40010400
#define IMR1 REG(EXTI + 0x00)
#define RTSR1 REG(EXTI + 0x08)
#define FTSR1 REG(EXTI + 0x0C)
#define SWIER1 REG(EXTI + 0x10)
#define PR1 REG(EXTI + 0x14)

static void wait(uint32_t turns) { for (volatile uint32_t i = 0; i < turns; ++i) {} }

// 160 MHz from the crystal, every step as the manual has it.
static void crystal_and_pll(void) {
    RCC_APB1ENR1 |= 1u << 28;
    (void)RCC_APB1ENR1;
    PWR_CR5 = 0;
    RCC_CR |= 1u << 16;
    while (!(RCC_CR & 1u << 17)) {}
    RCC_PLLCFGR = 0x01305053;
    RCC_CR |= 1u << 24;
    while (!(RCC_CR & 1u << 25)) {}
}
static void fast_clock(void) {
    crystal_and_pll();
    FLASH_ACR = DBG_SWEN | 4 | 7u << 8;
    RCC_CFGR = 8u << 4 | 1;
    RCC_CFGR = 8u << 4 | 3;
    while ((RCC_CFGR >> 2 & 3) != 3) {}
    wait(100);
    RCC_CFGR = 3;
}
static void pins_of_i2c1(void) {
    RCC_AHB2ENR |= 3;
    (void)RCC_AHB2ENR;
    REG(GPIOA + 0x04) |= 1u << 15;
    REG(GPIOA + 0x24) = (REG(GPIOA + 0x24) & ~(15u << 28)) | 4u << 28;
    REG(GPIOA + 0x00) = (REG(GPIOA + 0x00) & ~(3u << 30)) | 2u << 30;
    REG(GPIOB + 0x04) |= 1u << 7;
    REG(GPIOB + 0x20) = (REG(GPIOB + 0x20) & ~(15u << 28)) | 4u << 28;
    REG(GPIOB + 0x00) = (REG(GPIOB + 0x00) & ~(3u << 14)) | 2u << 14;
}
static void i2c_ready(void) {
    pins_of_i2c1();
    RCC_APB1ENR1 |= 1u << 21;
    (void)RCC_APB1ENR1;
    I2C1_TIMINGR = 0x00611011;  // 400 kHz from 16 MHz
    I2C1_CR1 = 1;
}
static void pins_of_can(void) {
    RCC_AHB2ENR |= 1;
    (void)RCC_AHB2ENR;
    REG(GPIOA + 0x24) = (REG(GPIOA + 0x24) & ~(0xFFu << 12)) | 0x99u << 12;
    REG(GPIOA + 0x00) = (REG(GPIOA + 0x00) & ~(15u << 22)) | 10u << 22;
}
static void can_clock(void) {
    fast_clock();
    RCC_CCIPR = 1u << 24;
    RCC_APB1ENR1 |= 1u << 25;
    pins_of_can();
    CCCR |= 1;
    while (!(CCCR & 1)) {}
}
static void can_configured(void) {
    can_clock();
    CCCR |= 2;
    REG(CAN + 0x100) = 0;
    NBTP = 15u << 25 | 0u << 16 | 62u << 8 | 15;  // 1 Mbit/s
    DBTP = 1u << 23 | 0u << 16 | 10u << 8 | 3u << 4 | 3;  // 5 Mbit/s
    TDCR = 12u << 8;
    CCCR |= 3u << 8;
}
static void can_running(void) {
    can_configured();
    CCCR &= ~1u;
    while (CCCR & 1) {}
    wait(3000);
}
static void uart_ready(void) {
    RCC_AHB2ENR |= 1;
    RCC_APB1ENR2 |= 1;
    (void)RCC_APB1ENR2;
    REG(GPIOA + 0x20) = 12u << 8;
    REG(GPIOA + 0x00) = (REG(GPIOA + 0x00) & ~(3u << 4)) | 2u << 4;
    REG(LPUART + 0x0C) = 35556;
    REG(LPUART + 0x00) = 9;
}

static void syscfg_ready(void) {
    RCC_APB2ENR |= 1;
    (void)RCC_APB2ENR;
}
// PB12, pulled up, on line 12.
static void pin_of_line_12(void) {
    RCC_AHB2ENR |= 2;
    (void)RCC_AHB2ENR;
    REG(GPIOB + 0x0C) |= 1u << 24;
    REG(GPIOB + 0x00) &= ~(3u << 24);
    syscfg_ready();
    EXTICR4 = 1;
}
static void listen_to_falls(void) {
    fast_clock();
    pin_of_line_12();
    FTSR1 |= 1u << 12;
    REG(0xE000E104) = 1u << (40 - 32);
    result[0] = 0;
    result[1] = 0;
    IMR1 |= 1u << 12;
}

// --- what is right
void everything_right(void) {
    fast_clock();
    finish();
}
void i2c_right(void) {
    i2c_ready();
    I2C1_CR2 = 0x50u << 1 | 1u << 13 | 1u << 25;
    while (!(I2C1_ISR & 1u << 5)) {}
    result[0] = I2C1_ISR;
    finish();
}
void can_right(void) {
    can_running();
    result[0] = REG(CAN + 0x44);
    finish();
}
void uart_right(void) {
    uart_ready();
    REG(LPUART + 0x28) = 'o';
    while (!(REG(LPUART + 0x1C) & 1u << 7)) {}
    REG(LPUART + 0x28) = 'k';
    while (!(REG(LPUART + 0x1C) & 1u << 6)) {}
    finish();
}

// The line: nothing, then an interrupt by software.
void exti_right(void) {
    listen_to_falls();
    wait(1000);
    result[2] = result[0];
    result[1] = 1;
    SWIER1 = 1u << 12;
    wait(10);
    result[3] = PR1 | SWIER1;
    finish();
}
// Falls every second microsecond; the handler takes five, each once.
void exti_falls(void) {
    listen_to_falls();
    result[1] = 1;
    while (result[0] < 5) {}
    IMR1 &= ~(1u << 12);
    PR1 = 1u << 12;
    wait(1000);
    result[2] = PR1;
    finish();
}
// Rises too: as many again.
void exti_both_edges(void) {
    RCC_APB1ENR1 |= 1;
    listen_to_falls();
    result[1] = 1;
    REG(0x40000028) = 159;
    REG(0x40000014) = 1;
    REG(0x40000000) = 1;
    const uint32_t begin = REG(0x40000024);
    result[0] = 0;
    while (REG(0x40000024) - begin < 100) {}
    result[2] = result[0];
    RTSR1 = 1u << 12;
    const uint32_t middle = REG(0x40000024);
    result[0] = 0;
    while (REG(0x40000024) - middle < 100) {}
    result[3] = result[0];
    finish();
}
// Not cleared: it comes again, whatever the line does.
void exti_not_cleared(void) {
    listen_to_falls();
    SWIER1 = 1u << 12;
    while (result[0] < 3) {}
    finish();
}
void irq_exti15_10(void) {
    if (++result[0] == 3 || result[1] != 0) PR1 = 1u << 12;
}

// --- external interrupts
void unclocked_syscfg(void) { EXTICR4 = 1; finish(); }
void syscfg_reserved_bits(void) { syscfg_ready(); EXTICR4 = 8; finish(); }
void line_of_no_port(void) { syscfg_ready(); EXTICR4 = 7; finish(); }
void exti_reserved_bits(void) { RTSR1 = 1u << 17; finish(); }
void exti_narrow_write(void) { REG16(EXTI + 0x0C) = 1u << 12; finish(); }
void exti_line_of_no_pin(void) { IMR1 |= 1u << 18; finish(); }
void exti_second_bank(void) { REG(EXTI + 0x20) = 0xFFFFFFFF; finish(); }
void exti_event(void) { REG(EXTI + 0x04) = 1u << 12; finish(); }
void exti_unknown_register(void) { (void)REG(EXTI + 0x18); finish(); }
void exti_analog_pin(void) {
    syscfg_ready();
    EXTICR4 = 1;
    FTSR1 = 1u << 12;
    IMR1 |= 1u << 12;
    finish();
}

// --- bus
void unclocked_gpio(void) { REG(GPIOA + 0x14) = 1; finish(); }
void unclocked_i2c(void) { (void)I2C1_ISR; finish(); }
void unclocked_message_ram(void) { REG(SRAMCAN) = 0; finish(); }
void unknown_peripheral(void) { (void)REG(0x40020000); finish(); }
void unknown_register(void) { i2c_ready(); (void)REG(I2C1 + 0x3C); finish(); }
void reserved_bits(void) { i2c_ready(); I2C1_CR2 = 1u << 31; finish(); }
void read_only_register(void) { RCC_AHB2ENR |= 1; (void)RCC_AHB2ENR; REG(GPIOA + 0x10) = 1; finish(); }
void narrow_write(void) { RCC_APB1ENR1 |= 1; (void)RCC_APB1ENR1; REG16(0x40000034) = 5; finish(); }
void narrow_message_ram(void) { can_clock(); REG8(SRAMCAN + 0x278) = 5; finish(); }

// --- clocks
void too_few_wait_states(void) {
    crystal_and_pll();
    FLASH_ACR = DBG_SWEN | 2;
    RCC_CFGR = 8u << 4 | 1;
    RCC_CFGR = 8u << 4 | 3;
    wait(100);
    RCC_CFGR = 3;
    finish();
}
void debugger_shut_out(void) {
    FLASH_ACR = 6u << 8;
    finish();
}
void no_boost(void) {
    crystal_and_pll();
    PWR_CR5 = 1u << 8;
    FLASH_ACR = DBG_SWEN | 4;
    RCC_CFGR = 8u << 4 | 1;
    RCC_CFGR = 8u << 4 | 3;
    wait(100);
    RCC_CFGR = 3;
    finish();
}
void no_half_speed_step(void) {
    crystal_and_pll();
    FLASH_ACR = DBG_SWEN | 4;
    RCC_CFGR = 3;
    finish();
}
void half_speed_too_short(void) {
    crystal_and_pll();
    FLASH_ACR = DBG_SWEN | 4;
    RCC_CFGR = 8u << 4 | 1;
    RCC_CFGR = 8u << 4 | 3;
    RCC_CFGR = 3;
    finish();
}
void pll_changed_while_on(void) { fast_clock(); RCC_PLLCFGR = 0x01305453; finish(); }
void pll_off_while_used(void) { fast_clock(); RCC_CR &= ~(1u << 24); finish(); }
void crystal_off_while_used(void) { fast_clock(); RCC_CR &= ~(1u << 16); finish(); }
void switch_to_dead_pll(void) { RCC_CFGR = 3; finish(); }
void vco_too_fast(void) {
    RCC_CR |= 1u << 16;
    while (!(RCC_CR & 1u << 17)) {}
    RCC_PLLCFGR = (0x01305053 & ~(0x7Fu << 8)) | 100u << 8;
    RCC_CR |= 1u << 24;
    finish();
}
void pll_without_source(void) { RCC_PLLCFGR = 0x01305053; RCC_CR |= 1u << 24; finish(); }
void flash_programming(void) { REG(0x40022008) = 0x45670123; finish(); }

// --- I2C
void timing_while_enabled(void) { i2c_ready(); I2C1_TIMINGR = 0x00611012; finish(); }
void too_fast_timing(void) {
    pins_of_i2c1();
    RCC_APB1ENR1 |= 1u << 21;
    I2C1_TIMINGR = 0x00200204;  // 1 MHz
    I2C1_CR1 = 1;
    I2C1_CR2 = 0x50u << 1 | 1u << 13 | 1u << 25;
    finish();
}
void start_without_pins(void) {
    RCC_APB1ENR1 |= 1u << 21;
    I2C1_TIMINGR = 0x00611011;
    I2C1_CR1 = 1;
    I2C1_CR2 = 0x50u << 1 | 1u << 13 | 1u << 25;
    finish();
}
void push_pull_pins(void) {
    pins_of_i2c1();
    REG(GPIOA + 0x04) = 0;
    RCC_APB1ENR1 |= 1u << 21;
    I2C1_TIMINGR = 0x00611011;
    I2C1_CR1 = 1;
    I2C1_CR2 = 0x50u << 1 | 1u << 13 | 1u << 25;
    finish();
}
void start_while_disabled(void) { i2c_ready(); I2C1_CR1 = 0; (void)I2C1_CR1; I2C1_CR2 = 0x50u << 1 | 1u << 13; finish(); }
void start_while_busy(void) {
    i2c_ready();
    I2C1_CR2 = 0x29u << 1 | 2u << 16 | 1u << 13 | 1u << 25;
    while (!(I2C1_ISR & 1u << 1)) {}
    I2C1_CR2 = 0x29u << 1 | 2u << 16 | 1u << 13 | 1u << 25;
    finish();
}
void start_twice(void) {
    i2c_ready();
    I2C1_CR2 = 0x29u << 1 | 2u << 16 | 1u << 13 | 1u << 25;
    I2C1_CR2 = 0x30u << 1 | 2u << 16 | 1u << 13 | 1u << 25;
    finish();
}
void data_overwritten(void) { i2c_ready(); I2C1_TXDR = 1; I2C1_TXDR = 2; finish(); }
void empty_data_read(void) { i2c_ready(); (void)I2C1_RXDR; finish(); }
void enable_pulse_too_short(void) { i2c_ready(); I2C1_CR1 = 0; I2C1_CR1 = 1; finish(); }
void line_driven_high(void) {
    i2c_ready();
    REG(GPIOA + 0x04) = 0;
    REG(GPIOA + 0x18) = 1u << 15;
    REG(GPIOA + 0x00) = (REG(GPIOA + 0x00) & ~(3u << 30)) | 1u << 30;
    finish();
}
void xshut_driven_high(void) {
    RCC_AHB2ENR |= 1;
    (void)RCC_AHB2ENR;
    REG(GPIOA + 0x18) = 1u << 4;
    REG(GPIOA + 0x00) = (REG(GPIOA + 0x00) & ~(3u << 8)) | 1u << 8;
    finish();
}

// --- CAN
void bit_timing_without_cce(void) { can_clock(); NBTP = 15u << 25 | 62u << 8 | 15; finish(); }
void cce_without_init(void) { can_running(); CCCR |= 2; finish(); }
void fd_without_cce(void) { can_running(); CCCR &= ~(1u << 8); finish(); }
void wrong_bit_rate(void) {
    can_configured();
    NBTP = 15u << 25 | 1u << 16 | 62u << 8 | 15;
    CCCR &= ~1u;
    wait(3000);
    finish();
}
void no_delay_compensation(void) {
    can_configured();
    DBTP = 10u << 8 | 3u << 4 | 3;
    CCCR &= ~1u;
    wait(3000);
    finish();
}
void wrong_delay_compensation(void) {
    can_configured();
    TDCR = 30u << 8;
    CCCR &= ~1u;
    wait(3000);
    finish();
}
void can_on_internal_clock(void) {
    RCC_CCIPR = 2u << 24;
    RCC_APB1ENR1 |= 1u << 25;
    pins_of_can();
    CCCR |= 1;
    wait(10);
    CCCR |= 2;
    NBTP = 12u << 8 | 1;
    CCCR &= ~1u;
    wait(3000);
    finish();
}
void request_during_init(void) { can_configured(); TXBAR = 1; finish(); }
void request_not_at_put_index(void) { can_running(); TXBAR = 4; finish(); }
void request_twice(void) { can_running(); TXBAR = 1; TXBAR = 1; finish(); }
void request_of_same_identifier(void) {
    can_configured();
    REG(CAN + 0xC0) = 1u << 24;
    CCCR &= ~1u;
    wait(3000);
    TXBAR = 1;
    TXBAR = 2;
    finish();
}
void acknowledge_empty_fifo(void) { can_running(); RXF0A = 0; finish(); }
void fd_frame_without_fdoe(void) {
    can_configured();
    CCCR &= ~(3u << 8);
    CCCR &= ~1u;
    wait(3000);
    REG(SRAMCAN + 0x278) = 0x100u << 18;
    REG(SRAMCAN + 0x27C) = 1u << 21 | 8u << 16;
    TXBAR = 1;
    finish();
}

// --- the rest
void watchdog_locked(void) { REG(IWDG + 0x08) = 100; finish(); }
void watchdog_while_updating(void) {
    REG(IWDG) = 0x5555;
    REG(IWDG + 0x08) = 100;
    REG(IWDG + 0x08) = 200;
    finish();
}
void watchdog_bad_key(void) { REG(IWDG) = 0x1234; finish(); }
void uart_divider_while_enabled(void) { uart_ready(); REG(LPUART + 0x0C) = 40000; finish(); }
void uart_wrong_rate(void) {
    uart_ready();
    REG(LPUART + 0x00) = 0;
    REG(LPUART + 0x0C) = 50000;
    REG(LPUART + 0x00) = 9;
    finish();
}
void uart_overwritten(void) { uart_ready(); for (int i = 0; i < 3; ++i) REG(LPUART + 0x28) = 'x'; finish(); }
void uart_off(void) { uart_ready(); REG(LPUART + 0x00) = 0; REG(LPUART + 0x28) = 'x'; finish(); }
void priority_bits(void) { REG8(0xE000E400) = 0x11; finish(); }
void vector_table_alignment(void) { REG(0xE000ED08) = 0x08000100; finish(); }
void reset_without_key(void) { REG(0xE000ED0C) = 4; finish(); }
void deep_sleep(void) { REG(0xE000ED10) = 4; finish(); }

// --- what must happen without a violation
static void microsecond_timer(uint32_t period) {
    RCC_APB1ENR1 |= 1;
    (void)RCC_APB1ENR1;
    REG(0x40000028) = 15;
    REG(0x4000002C) = period - 1;
    REG(0x40000014) = 1;
    REG(0x40000010) = 0;
    REG(0x40000000) = 1;
}
// An interrupt whose flag stays set comes again and again.
void level_interrupt(void) {
    result[0] = 0;
    microsecond_timer(100);
    REG(0x4000000C) = 1;
    REG(0xE000E100) = 1u << 28;
    while (result[0] < 3) {}
    wait(10);
    finish();
}
void irq_tim2(void) {
    if (++result[0] == 3) {
        REG(0x4000000C) = 0;
        REG(0x40000010) = 0;
    }
}
// A compare matches when the counter arrives, not while it is there; then once a period.
void timer_compare(void) {
    microsecond_timer(1000);
    REG(0x40000034) = 500;
    REG(0x40000010) = 0;
    while (!(REG(0x40000010) & 2)) {}
    result[0] = REG(0x40000024);
    REG(0x40000024) = 500;
    REG(0x40000010) = 0;
    wait(200);
    result[1] = REG(0x40000010) & 2;
    while (!(REG(0x40000010) & 2)) {}
    result[2] = REG(0x40000024);
    result[3] = REG(0x40000010) & 1;
    finish();
}
void watchdog_bites(void) {
    REG(IWDG) = 0xCCCC;
    REG(IWDG) = 0x5555;
    REG(IWDG + 0x04) = 2;
    REG(IWDG + 0x08) = 299;
    while (REG(IWDG + 0x0C)) {}
    REG(IWDG) = 0xAAAA;
    is_finished = 2;
    for (;;) {}
}
void software_reset(void) {
    is_finished = 2;
    REG(0xE000ED0C) = 0x05FA0004;
    for (;;) {}
}
void security_system(void) {
    fast_clock();
    RCC_CR |= 1u << 19;
    is_finished = 2;
    for (;;) {}
}
void nmi(void) {
    result[0] = REG(RCC + 0x1C);
    result[1] = RCC_CFGR >> 2 & 3;
    REG(RCC + 0x20) = 1u << 8;
    finish();
}
// Reset cause as the program sees it after each reset; is_finished tells that it was not power-up's garbage.
void reset(void) {
    if (is_finished == 2) {
        result[0] = REG(RCC + 0x94);
        finish();
    }
    for (;;) __asm volatile("wfi");
}
