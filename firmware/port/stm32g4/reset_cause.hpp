// The cause of the last reset, from the flags in RCC_CSR.
#pragma once

#include <cstdint>

#include "common/wire/messages.hpp"

namespace octoskin::stm32g4 {

/// RM0440, RCC_CSR: every reset also drives the reset pin, so the pin's flag means the pin only if it is the
/// only flag. Power-on and a supply dip set the same flag; `is_ram_kept` distinguishes them.
[[nodiscard]] wire::ResetCause reset_cause(std::uint32_t csr, bool is_ram_kept) noexcept;

/// Reads RCC_CSR and clears its flags for the next reset.
[[nodiscard]] std::uint32_t take_reset_flags();

}  // namespace octoskin::stm32g4
