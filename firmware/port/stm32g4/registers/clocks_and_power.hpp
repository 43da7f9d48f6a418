// Reset and clock control, power, flash timing. Offsets and bits: RM0440, as in ST's SVD file.
#pragma once

#include <array>

#include "firmware/port/stm32g4/registers/register_map.hpp"

namespace octoskin::stm32g4 {

struct RccMap {
    static constexpr auto kInstances = std::to_array<Instance>({{"RCC", 0x4002'1000}});
    static constexpr auto kRegisters = std::to_array<RegisterEntry>({
        {"CR", 0x00},
        {"CFGR", 0x08},
        {"PLLCFGR", 0x0C},
        {"CIFR", 0x1C},
        {"AHB2ENR", 0x4C},
        {"APB1ENR1", 0x58},
        {"APB1ENR2", 0x5C},
        {"APB2ENR", 0x60},
        {"CCIPR", 0x88},

        {"CSR", 0x94},
    });
    static constexpr auto kFields = std::to_array<FieldEntry>({
        {"CR.HSEON", 16},          {"CR.HSERDY", 17},        {"CR.CSSON", 19},
        {"CR.PLLON", 24},          {"CR.PLLRDY", 25},        {"CFGR.SW", 0, 2},
        {"CFGR.SWS", 2, 2},        {"CFGR.HPRE", 4, 4},      {"CFGR.PPRE1", 8, 3},
        {"CFGR.PPRE2", 11, 3},     {"PLLCFGR.PLLSRC", 0, 2}, {"PLLCFGR.PLLM", 4, 4},
        {"PLLCFGR.PLLN", 8, 7},    {"PLLCFGR.PLLQEN", 20},   {"PLLCFGR.PLLQ", 21, 2},
        {"PLLCFGR.PLLREN", 24},    {"PLLCFGR.PLLR", 25, 2},  {"CIFR.CSSF", 8},
        {"AHB2ENR.GPIOAEN", 0},    {"AHB2ENR.GPIOBEN", 1},   {"AHB2ENR.GPIOCEN", 2},
        {"APB1ENR1.TIM2EN", 0},    {"APB1ENR1.I2C1EN", 21},  {"APB1ENR1.I2C2EN", 22},
        {"APB1ENR1.FDCANEN", 25},  {"APB1ENR1.PWREN", 28},   {"APB1ENR1.I2C3EN", 30},
        {"APB1ENR2.LPUART1EN", 0}, {"APB1ENR2.I2C4EN", 1},   {"APB2ENR.SYSCFGEN", 0},

        {"CCIPR.FDCANSEL", 24, 2}, {"CSR.RMVF", 23},         {"CSR.OBLRSTF", 25},
        {"CSR.PINRSTF", 26},       {"CSR.BORRSTF", 27},      {"CSR.SFTRSTF", 28},
        {"CSR.IWDGRSTF", 29},      {"CSR.WWDGRSTF", 30},     {"CSR.LPWRRSTF", 31},
    });
};
inline constexpr Peripheral<RccMap> rcc{"RCC"};

struct PwrMap {
    static constexpr auto kInstances = std::to_array<Instance>({{"PWR", 0x4000'7000}});
    static constexpr auto kRegisters = std::to_array<RegisterEntry>({
        {"CR1", 0x00},
        {"CR3", 0x08},
        {"CR5", 0x80},
    });
    static constexpr auto kFields = std::to_array<FieldEntry>({
        {"CR1.VOS", 9, 2},
        {"CR3.UCPD1_DBDIS", 14},
        {"CR5.R1MODE", 8},
    });
};
inline constexpr Peripheral<PwrMap> pwr{"PWR"};

struct FlashMap {
    static constexpr auto kInstances = std::to_array<Instance>({{"FLASH", 0x4002'2000}});
    static constexpr auto kRegisters = std::to_array<RegisterEntry>({{"ACR", 0x00}, {"ECCR", 0x18}});
    static constexpr auto kFields = std::to_array<FieldEntry>({
        {"ACR.LATENCY", 0, 4},
        {"ACR.PRFTEN", 8},
        {"ACR.ICEN", 9},
        {"ACR.DCEN", 10},
        {"ECCR.ADDR_ECC", 0, 19},
        {"ECCR.BK_ECC", 21},
        {"ECCR.ECCD", 31},
    });
};
inline constexpr Peripheral<FlashMap> flash{"FLASH"};

}  // namespace octoskin::stm32g4
