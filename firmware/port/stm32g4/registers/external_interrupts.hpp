// Interrupts from pins: port selection (SYSCFG) and edge detection (EXTI). Offsets and bits: RM0440, as in
// ST's SVD file. The SVD file makes the port number one bit wider than the chip does.
#pragma once

#include <array>

#include "firmware/port/stm32g4/registers/register_map.hpp"

namespace octoskin::stm32g4 {

struct SyscfgMap {
    static constexpr auto kInstances = std::to_array<Instance>({{"SYSCFG", 0x4001'0000}});
    static constexpr auto kRegisters = std::to_array<RegisterEntry>({{"EXTICR4", 0x14}});
    static constexpr auto kFields = std::to_array<FieldEntry>({{"EXTICR4.EXTI#", 0, 4, 4, 12}});
};
inline constexpr Peripheral<SyscfgMap> syscfg{"SYSCFG"};

struct ExtiMap {
    static constexpr auto kInstances = std::to_array<Instance>({{"EXTI", 0x4001'0400}});
    static constexpr auto kRegisters = std::to_array<RegisterEntry>({
        {"IMR1", 0x00},
        {"FTSR1", 0x0C},
        {"PR1", 0x14},
    });
    static constexpr auto kFields = std::to_array<FieldEntry>({
        {"IMR1.IM#", 0, 1, 16},
        {"FTSR1.FT#", 0, 1, 16},
        {"PR1.PIF#", 0, 1, 16},
    });
};
inline constexpr Peripheral<ExtiMap> exti{"EXTI"};

}  // namespace octoskin::stm32g4
