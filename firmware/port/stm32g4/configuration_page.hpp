// The flash page that holds this board's configuration block. Flashing merges it with the image.
#pragma once

#include <cstdint>
#include <span>

#include "common/config/node_config.hpp"

namespace octoskin::stm32g4 {

/// The last 2 KiB of the flash.
inline constexpr std::uint32_t kConfigurationPage = 0x0807'F800;

[[nodiscard]] inline std::span<const std::uint8_t, kNodeConfigBytesMax> configuration_page() {
    // NOLINTBEGIN(performance-no-int-to-ptr): it is at an address, not a variable.
    return std::span<const std::uint8_t, kNodeConfigBytesMax>(
        reinterpret_cast<const std::uint8_t*>(std::uintptr_t{kConfigurationPage}), kNodeConfigBytesMax);
    // NOLINTEND(performance-no-int-to-ptr)
}

}  // namespace octoskin::stm32g4
