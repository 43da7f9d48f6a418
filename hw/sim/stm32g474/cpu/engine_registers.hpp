// Access to several registers of Unicorn in one call, which costs little more than one register.
#pragma once

#include <unicorn/unicorn.h>

#include <array>
#include <cstddef>
#include <cstdint>

namespace octoskin::sim::stm32 {

template <std::size_t kCount>
using EngineRegisters = std::array<int, kCount>;  ///< of uc_arm_reg
template <std::size_t kCount>
using RegisterValues = std::array<std::uint32_t, kCount>;

/// CONTROL: floating point was used since this bit was cleared.
inline constexpr std::uint32_t kFpContext = 1U << 2;

/// Values in the order of `registers`; each register must exist.
template <std::size_t kCount>
[[nodiscard]] RegisterValues<kCount> read_registers(uc_engine* engine, EngineRegisters<kCount> registers) {
    RegisterValues<kCount> values{};
    std::array<void*, kCount> places{};
    for (std::size_t i = 0; i < kCount; ++i) places[i] = &values[i];
    uc_reg_read_batch(engine, registers.data(), places.data(), static_cast<int>(kCount));
    return values;
}

/// Writes the values in the order of `registers`.
template <std::size_t kCount>
void write_registers(uc_engine* engine, EngineRegisters<kCount> registers, RegisterValues<kCount> values) {
    std::array<void*, kCount> places{};
    for (std::size_t i = 0; i < kCount; ++i) places[i] = &values[i];
    uc_reg_write_batch(engine, registers.data(), places.data(), static_cast<int>(kCount));
}

}  // namespace octoskin::sim::stm32
