// The interrupts in use. RM0440, vector table; names as in ST's SVD file, which calls LPUART1's "LPUART".
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace octoskin::stm32g4 {

inline constexpr std::size_t kExceptionCount = 16;
inline constexpr std::size_t kInterruptCount = 102;  ///< the highest number is 101

enum class Interrupt : std::uint8_t {
    fdcan1_it0 = 21,
    tim2 = 28,
    i2c1_event = 31,
    i2c1_error = 32,
    i2c2_event = 33,
    i2c2_error = 34,
    exti10_to_15 = 40,
    i2c4_event = 82,
    i2c4_error = 83,
    lpuart1 = 91,
    i2c3_event = 92,
    i2c3_error = 93,
};

struct InterruptEntry {
    std::string_view name;  ///< ST's
    Interrupt number;
};
inline constexpr auto kInterruptNames = std::to_array<InterruptEntry>({
    {"FDCAN1_IT0", Interrupt::fdcan1_it0},
    {"TIM2", Interrupt::tim2},
    {"I2C1_EV", Interrupt::i2c1_event},
    {"I2C1_ER", Interrupt::i2c1_error},
    {"I2C2_EV", Interrupt::i2c2_event},
    {"I2C2_ER", Interrupt::i2c2_error},
    {"EXTI15_10", Interrupt::exti10_to_15},
    {"I2C3_EV", Interrupt::i2c3_event},
    {"I2C3_ER", Interrupt::i2c3_error},
    {"I2C4_EV", Interrupt::i2c4_event},
    {"I2C4_ER", Interrupt::i2c4_error},
    {"LPUART", Interrupt::lpuart1},
});

}  // namespace octoskin::stm32g4
