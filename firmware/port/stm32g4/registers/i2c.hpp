// The four I2C controllers. Offsets and bits: RM0440, as in ST's SVD file.
#pragma once

#include <array>

#include "firmware/port/stm32g4/registers/register_map.hpp"

namespace octoskin::stm32g4 {

struct I2cMap {
    static constexpr auto kInstances = std::to_array<Instance>(
        {{"I2C1", 0x4000'5400}, {"I2C2", 0x4000'5800}, {"I2C3", 0x4000'7800}, {"I2C4", 0x4000'8400}});
    static constexpr auto kRegisters = std::to_array<RegisterEntry>({
        {"CR1", 0x00},
        {"CR2", 0x04},
        {"TIMINGR", 0x10},
        {"ISR", 0x18},
        {"ICR", 0x1C},
        {"RXDR", 0x24},
        {"TXDR", 0x28},
    });
    static constexpr auto kFields = std::to_array<FieldEntry>({
        {"CR1.PE", 0},
        {"CR1.TXIE", 1},
        {"CR1.RXIE", 2},
        {"CR1.NACKIE", 4},
        {"CR1.STOPIE", 5},
        {"CR1.TCIE", 6},
        {"CR1.ERRIE", 7},
        {"CR2.SADD", 0, 10},
        {"CR2.RD_WRN", 10},
        {"CR2.START", 13},
        {"CR2.NBYTES", 16, 8},
        {"CR2.AUTOEND", 25},
        {"TIMINGR.SCLL", 0, 8},
        {"TIMINGR.SCLH", 8, 8},
        {"TIMINGR.SDADEL", 16, 4},
        {"TIMINGR.SCLDEL", 20, 4},
        {"TIMINGR.PRESC", 28, 4},
        {"ISR.TXE", 0},
        {"ISR.TXIS", 1},
        {"ISR.RXNE", 2},
        {"ISR.NACKF", 4},
        {"ISR.STOPF", 5},
        {"ISR.TC", 6},
        {"ISR.BERR", 8},
        {"ISR.ARLO", 9},
        {"ISR.OVR", 10},
        {"ISR.BUSY", 15},
        {"ICR.NACKCF", 4},
        {"ICR.STOPCF", 5},
        {"ICR.BERRCF", 8},
        {"ICR.ARLOCF", 9},
        {"ICR.OVRCF", 10},
        {"RXDR.RXDATA", 0, 8},
        {"TXDR.TXDATA", 0, 8},
    });
};
inline constexpr Peripheral<I2cMap> i2c1{"I2C1"};
inline constexpr Peripheral<I2cMap> i2c2{"I2C2"};
inline constexpr Peripheral<I2cMap> i2c3{"I2C3"};
inline constexpr Peripheral<I2cMap> i2c4{"I2C4"};

}  // namespace octoskin::stm32g4
