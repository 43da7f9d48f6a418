// Pins, clock and interrupts of each I2C controller on the NUCLEO-G474RE. Datasheet DS12288, alternate
// functions. Each bus needs external pull-ups: the chip's own are too weak for 400 kHz.
#pragma once

#include <array>

#include "firmware/port/stm32g4/pin.hpp"
#include "firmware/port/stm32g4/registers/clocks_and_power.hpp"
#include "firmware/port/stm32g4/registers/i2c.hpp"
#include "firmware/port/stm32g4/registers/interrupts.hpp"

namespace octoskin::stm32g4 {

struct I2cWiring {
    Peripheral<I2cMap> registers;
    Field<RccMap> clock;  ///< its enable bit; the kernel clock is PCLK1, the reset default
    Interrupt event;
    Interrupt error;
    Pin scl;
    Pin sda;
    std::uint8_t function;
};

/// In the order of the configuration's bus index.
inline constexpr std::array<I2cWiring, 4> kI2cWirings = {{
    {i2c1, "APB1ENR1.I2C1EN", Interrupt::i2c1_event, Interrupt::i2c1_error, {gpio_a, 15}, {gpio_b, 7}, 4},
    {i2c2, "APB1ENR1.I2C2EN", Interrupt::i2c2_event, Interrupt::i2c2_error, {gpio_a, 9}, {gpio_a, 8}, 4},
    {i2c3, "APB1ENR1.I2C3EN", Interrupt::i2c3_event, Interrupt::i2c3_error, {gpio_c, 8}, {gpio_c, 9}, 8},
    {i2c4, "APB1ENR2.I2C4EN", Interrupt::i2c4_event, Interrupt::i2c4_error, {gpio_c, 6}, {gpio_c, 7}, 8},
}};

}  // namespace octoskin::stm32g4
