// Why the chip was reset, from the flags in RCC_CSR.
#pragma once

#include <cstdint>

#include "common/wire/messages.hpp"

namespace octoskin::stm32g4 {

/// RM0440, RCC_CSR: every reset also drives the reset pin, so its flag alone means the pin; a first power-up
/// and a dip of the supply have the same flag, and RAM that was kept tells them apart.
[[nodiscard]] wire::ResetCause reset_cause(std::uint32_t csr, bool is_ram_kept) noexcept;

/// Reads RCC_CSR and clears its flags for the next reset.
[[nodiscard]] std::uint32_t take_reset_flags();

}  // namespace octoskin::stm32g4
