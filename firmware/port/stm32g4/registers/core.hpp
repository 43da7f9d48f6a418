// Registers of the Cortex-M4: interrupt controller, system control, FPU. ARMv7-M architecture, as in ST's SVD
// file.
#pragma once

#include <array>

#include "firmware/port/stm32g4/registers/register_map.hpp"

namespace octoskin::stm32g4 {

struct NvicMap {
    static constexpr auto kInstances = std::to_array<Instance>({{"NVIC", 0xE000'E100}});
    static constexpr auto kRegisters = std::to_array<RegisterEntry>({
        {"ISER#", 0x000, 4},
        {"ICER#", 0x080, 4},
        {"IPR#", 0x300, 26},
    });
    static constexpr auto kFields = std::to_array<FieldEntry>({
        {"IPR#.IPR_N#", 0, 8, 4},  // one byte per interrupt
    });
};
inline constexpr Peripheral<NvicMap> nvic{"NVIC"};

struct ScbMap {
    static constexpr auto kInstances = std::to_array<Instance>({{"SCB", 0xE000'ED00}});
    static constexpr auto kRegisters = std::to_array<RegisterEntry>({
        {"ICSR", 0x04},
        {"VTOR", 0x08},
        {"AIRCR", 0x0C},
        {"CCR", 0x14},
        {"CFSR_UFSR_BFSR_MMFSR", 0x28},

        {"MMFAR", 0x34},
        {"BFAR", 0x38},
    });
    static constexpr auto kFields = std::to_array<FieldEntry>({
        {"ICSR.VECTACTIVE", 0, 9},
        {"AIRCR.SYSRESETREQ", 2},
        {"AIRCR.VECTKEYSTAT", 16, 16},
        {"CCR.DIV_0_TRP", 4},
        {"CFSR_UFSR_BFSR_MMFSR.MMARVALID", 7},
        {"CFSR_UFSR_BFSR_MMFSR.BFARVALID", 15},
    });
};
inline constexpr Peripheral<ScbMap> scb{"SCB"};

struct FpuMap {
    static constexpr auto kInstances = std::to_array<Instance>({{"FPU", 0xE000'EF34}});
    static constexpr auto kRegisters = std::to_array<RegisterEntry>({{"FPCCR", 0x00}});
    static constexpr auto kFields = std::to_array<FieldEntry>({

        {"FPCCR.ASPEN", 31},
    });
};
inline constexpr Peripheral<FpuMap> fpu{"FPU"};

struct CpacrMap {
    static constexpr auto kInstances = std::to_array<Instance>({{"FPU_CPACR", 0xE000'ED88}});
    static constexpr auto kRegisters = std::to_array<RegisterEntry>({{"CPACR", 0x00}});
    static constexpr auto kFields = std::to_array<FieldEntry>({{"CPACR.CP", 20, 4}});
};
inline constexpr Peripheral<CpacrMap> cpacr{"FPU_CPACR"};

}  // namespace octoskin::stm32g4
