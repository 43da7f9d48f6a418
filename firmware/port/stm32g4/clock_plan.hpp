// PLL settings for 160 MHz, checked at compile time. RM0440 "PLL".
#pragma once

#include <cstdint>

#include "firmware/port/stm32g4/registers/clocks_and_power.hpp"

namespace octoskin::stm32g4 {

inline constexpr std::uint32_t kInternalHz = 16'000'000;  ///< HSI16, about 1 % off
inline constexpr std::uint32_t kCrystalHz = 24'000'000;   ///< HSE of the NUCLEO-G474RE

struct ClockPlan {
    std::uint32_t source_hz = 0;
    std::uint32_t source_select = 0;  ///< PLLCFGR.PLLSRC: 2 HSI16, 3 HSE
    std::uint32_t divide_in = 1;      ///< M
    std::uint32_t multiply = 8;       ///< N
    std::uint32_t divide_can = 2;     ///< Q: the CAN controller's clock
    std::uint32_t divide_core = 2;    ///< R: core and buses

    [[nodiscard]] constexpr std::uint32_t vco_in_hz() const { return source_hz / divide_in; }
    [[nodiscard]] constexpr std::uint32_t vco_hz() const { return vco_in_hz() * multiply; }
    [[nodiscard]] constexpr std::uint32_t core_hz() const { return vco_hz() / divide_core; }
    [[nodiscard]] constexpr std::uint32_t can_hz() const { return vco_hz() / divide_can; }

    [[nodiscard]] constexpr std::uint32_t pllcfgr() const {
        using F = Field<RccMap>;
        return F("PLLCFGR.PLLSRC")(source_select) | F("PLLCFGR.PLLM")(divide_in - 1) |
               F("PLLCFGR.PLLN")(multiply) | F("PLLCFGR.PLLQEN")(1) | F("PLLCFGR.PLLQ")(divide_can / 2 - 1) |
               F("PLLCFGR.PLLREN")(1) | F("PLLCFGR.PLLR")(divide_core / 2 - 1);
    }

    /// True if all values are within the ranges of RM0440 and of ST's HAL (stm32g4xx_hal_rcc.h).
    [[nodiscard]] constexpr bool is_allowed() const {
        const auto is_post_divider = [](std::uint32_t d) { return d == 2 || d == 4 || d == 6 || d == 8; };
        return source_hz % divide_in == 0 && divide_in >= 1 && divide_in <= 16 && multiply >= 8 &&
               multiply <= 127 && is_post_divider(divide_can) && is_post_divider(divide_core) &&
               vco_in_hz() >= 2'660'000 && vco_in_hz() <= 16'000'000 && vco_hz() >= 96'000'000 &&
               vco_hz() <= 344'000'000 && core_hz() <= 170'000'000;
    }
};

/// 160 MHz rather than 170, since 80 MHz for CAN is a multiple of every usual rate, including 5 Mbit/s.
inline constexpr ClockPlan kCrystalPlan{.source_hz = kCrystalHz,
                                        .source_select = 3,
                                        .divide_in = 6,
                                        .multiply = 80,
                                        .divide_can = 4,
                                        .divide_core = 2};
/// The same frequencies without the crystal; too inaccurate for CAN.
inline constexpr ClockPlan kInternalPlan{.source_hz = kInternalHz,
                                         .source_select = 2,
                                         .divide_in = 4,
                                         .multiply = 80,
                                         .divide_can = 4,
                                         .divide_core = 2};
static_assert(kCrystalPlan.is_allowed() && kInternalPlan.is_allowed());
static_assert(kCrystalPlan.core_hz() == 160'000'000 && kCrystalPlan.can_hz() == 80'000'000);
static_assert(kInternalPlan.core_hz() == 160'000'000);

/// The CAN controller's clock, when the crystal runs.
inline constexpr std::uint32_t kCanHz = kCrystalPlan.can_hz();

/// Flash wait states in range 1 boost mode: one for each further 34 MHz or part of it (RM0440).
[[nodiscard]] constexpr std::uint32_t flash_wait_states(std::uint32_t core_hz) {
    return (core_hz - 1) / 34'000'000;
}
static_assert(flash_wait_states(34'000'000) == 0 && flash_wait_states(160'000'000) == 4);

}  // namespace octoskin::stm32g4
