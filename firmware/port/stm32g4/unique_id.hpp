// The chip's 96-bit unique id, at 0x1FFF7590 (RM0440 "Unique device ID register").
#pragma once

#include <array>
#include <cstdint>

#include "firmware/port/stm32g4/registers/memory_access.hpp"

namespace octoskin::stm32g4 {

inline constexpr Address kUniqueIdAddress = 0x1FFF'7590;

/// The bytes in memory order.
[[nodiscard]] inline std::array<std::uint8_t, 12> unique_id() {
    std::array<std::uint8_t, 12> id{};
    for (std::uint32_t i = 0; i < id.size(); ++i) {
        const std::uint32_t word = load(kUniqueIdAddress + 4 * (i / 4));
        id[i] = static_cast<std::uint8_t>((word >> (8 * (i % 4))) & 0xFFU);
    }
    return id;
}

}  // namespace octoskin::stm32g4
