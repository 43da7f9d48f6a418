// The GPIO ports. Offsets and bits: RM0440, as in ST's SVD file.
#pragma once

#include <array>

#include "firmware/port/stm32g4/registers/register_map.hpp"

namespace octoskin::stm32g4 {

struct GpioMap {
    static constexpr auto kInstances =
        std::to_array<Instance>({{"GPIOA", 0x4800'0000}, {"GPIOB", 0x4800'0400}, {"GPIOC", 0x4800'0800}});
    static constexpr auto kRegisters = std::to_array<RegisterEntry>({
        {"MODER", 0x00},
        {"OTYPER", 0x04},
        {"OSPEEDR", 0x08},
        {"PUPDR", 0x0C},
        {"IDR", 0x10},
        {"BSRR", 0x18},
        {"AFRL", 0x20},
        {"AFRH", 0x24},
    });
    static constexpr auto kFields = std::to_array<FieldEntry>({
        {"MODER.MODER#", 0, 2, 16},
        {"OTYPER.OT#", 0, 1, 16},
        {"OSPEEDR.OSPEEDR#", 0, 2, 16},
        {"PUPDR.PUPDR#", 0, 2, 16},
        {"IDR.IDR#", 0, 1, 16},
        {"BSRR.BS#", 0, 1, 16},
        {"BSRR.BR#", 16, 1, 16},
        {"AFRL.AFRL#", 0, 4, 8},
        {"AFRH.AFRH#", 0, 4, 8, 8},
    });
};
inline constexpr Peripheral<GpioMap> gpio_a{"GPIOA"};
inline constexpr Peripheral<GpioMap> gpio_b{"GPIOB"};
inline constexpr Peripheral<GpioMap> gpio_c{"GPIOC"};

}  // namespace octoskin::stm32g4
