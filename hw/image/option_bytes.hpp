// The option bytes of the STM32G474 that a board depends on: FLASH_OPTR. RM0440, "Option bytes"; bit
// positions as in ST's CMSIS header.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace octoskin::image {

/// Address of FLASH_OPTR, and its offset from the flash interface's base, as OpenOCD expects it.
inline constexpr std::uint32_t kOptionRegister = 0x4002'2020;
inline constexpr std::uint32_t kOptionRegisterOffset = 0x20;

/// The required fields and their values, as `--write-option-bytes` writes them. The read protection is not
/// among them: changing it would erase the chip or lock it permanently.
struct MaskedWord {
    std::uint32_t mask = 0;
    std::uint32_t value = 0;
};
[[nodiscard]] MaskedWord wanted_option_bytes();

/// All checked fields with their values: "BOR_LEV 4, BFB2 0, ...". Then those that `--write-option-bytes`
/// does not write.
[[nodiscard]] std::string wanted_text();
[[nodiscard]] std::string unwritten_text();

/// One message per field that differs from its required value; empty if none does.
[[nodiscard]] std::vector<std::string> option_byte_faults(std::uint32_t flash_optr);

/// Whether the chip refuses programming (read protection level 1 or 2).
[[nodiscard]] constexpr bool is_read_protected(std::uint32_t flash_optr) {
    return (flash_optr & 0xFFU) != 0xAA;
}

}  // namespace octoskin::image
