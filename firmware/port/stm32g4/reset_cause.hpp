// Why the chip was reset, from the flags in RCC_CSR.
#pragma once

#include <cstdint>

#include "common/wire/messages.hpp"

namespace octoskin::stm32g4 {

/// What RAM that outlives a reset adds to the flags.
struct RetainedEvidence {
    bool is_ram_kept = false;   ///< a record with a valid CRC was there: the supply never went away for long
    bool is_fault_new = false;  ///< a fault handler asked for this reset
};

/// RM0440, RCC_CSR: every reset also drives the reset pin, so its flag alone means the pin; a first power-up
/// and a dip of the supply have the same flag, and RAM that was kept tells them apart.
[[nodiscard]] wire::ResetCause reset_cause(std::uint32_t csr, const RetainedEvidence& evidence) noexcept;

/// Reads RCC_CSR and clears its flags for the next reset.
[[nodiscard]] std::uint32_t take_reset_flags();

}  // namespace octoskin::stm32g4
