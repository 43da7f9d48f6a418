// Timer 2 (32 bits) and the independent watchdog. Offsets and bits: RM0440, as in ST's SVD file.
#pragma once

#include <array>

#include "firmware/port/stm32g4/registers/register_map.hpp"

namespace octoskin::stm32g4 {

struct TimerMap {
    static constexpr auto kInstances = std::to_array<Instance>({{"TIM2", 0x4000'0000}});
    static constexpr auto kRegisters = std::to_array<RegisterEntry>({
        {"CR1", 0x00},
        {"DIER", 0x0C},
        {"SR", 0x10},
        {"EGR", 0x14},
        {"CNT", 0x24},
        {"PSC", 0x28},
        {"ARR", 0x2C},
        {"CCR1", 0x34},
    });
    static constexpr auto kFields = std::to_array<FieldEntry>({
        {"CR1.CEN", 0},
        {"DIER.CC1IE", 1},
        {"SR.CC1IF", 1},
        {"EGR.UG", 0},
        {"EGR.CC1G", 1},
    });
};
inline constexpr Peripheral<TimerMap> tim2{"TIM2"};

struct IwdgMap {
    static constexpr auto kInstances = std::to_array<Instance>({{"IWDG", 0x4000'3000}});
    static constexpr auto kRegisters = std::to_array<RegisterEntry>({
        {"KR", 0x00},
        {"PR", 0x04},
        {"RLR", 0x08},
        {"SR", 0x0C},
    });
    static constexpr auto kFields = std::to_array<FieldEntry>({
        {"KR.KEY", 0, 16},
        {"PR.PR", 0, 3},
        {"RLR.RL", 0, 12},
        {"SR.PVU", 0},
        {"SR.RVU", 1},
    });
};
inline constexpr Peripheral<IwdgMap> iwdg{"IWDG"};

}  // namespace octoskin::stm32g4
