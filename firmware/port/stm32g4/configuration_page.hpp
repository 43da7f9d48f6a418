// The flash page with this board's configuration block, which flashing writes together with the image.
#pragma once

#include <cstdint>
#include <span>

#include "common/config/node_config.hpp"

namespace octoskin::stm32g4 {

/// The last 2 KiB of the flash.
inline constexpr std::uint32_t kConfigurationPage = 0x0807'F800;

/// Whether an error reported by FLASH_ECCR lies in the configuration block. RM0440: ADDR_ECC counts bytes
/// from the start of the bank, or of the flash in single-bank mode.
[[nodiscard]] constexpr bool is_in_configuration_page(std::uint32_t address_in_bank,
                                                      bool is_second_bank) noexcept {
    constexpr std::uint32_t kFlash = 0x0800'0000;
    constexpr std::uint32_t kBankBytes = 256 * 1024;
    const std::uint32_t address = kFlash + (address_in_bank | (is_second_bank ? kBankBytes : 0));
    return address >= kConfigurationPage && address < kConfigurationPage + kNodeConfigBytesMax;
}

[[nodiscard]] inline std::span<const std::uint8_t, kNodeConfigBytesMax> configuration_page() {
    // NOLINTBEGIN(performance-no-int-to-ptr): it is at an address, not a variable.
    return std::span<const std::uint8_t, kNodeConfigBytesMax>(
        reinterpret_cast<const std::uint8_t*>(std::uintptr_t{kConfigurationPage}), kNodeConfigBytesMax);
    // NOLINTEND(performance-no-int-to-ptr)
}

}  // namespace octoskin::stm32g4
