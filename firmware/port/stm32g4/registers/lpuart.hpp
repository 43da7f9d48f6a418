// The low-power UART behind the board's virtual serial port. Offsets and bits: RM0440, as in ST's SVD file.
#pragma once

#include <array>

#include "firmware/port/stm32g4/registers/register_map.hpp"

namespace octoskin::stm32g4 {

struct LpuartMap {
    static constexpr auto kInstances = std::to_array<Instance>({{"LPUART1", 0x4000'8000}});
    static constexpr auto kRegisters = std::to_array<RegisterEntry>({
        {"CR1", 0x00},
        {"BRR", 0x0C},
        {"ISR", 0x1C},
        {"TDR", 0x28},
    });
    static constexpr auto kFields = std::to_array<FieldEntry>({
        {"CR1.UE", 0},
        {"CR1.TE", 3},
        {"CR1.TXEIE", 7},
        {"BRR.BRR", 0, 20},
        {"ISR.TXE", 7},
        {"TDR.TDR", 0, 9},
    });
};
inline constexpr Peripheral<LpuartMap> lpuart1{"LPUART1"};

}  // namespace octoskin::stm32g4
