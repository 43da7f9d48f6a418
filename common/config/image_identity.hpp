// The identity in a firmware image, for the flashing tool: which layout of the configuration block the
// program reads. It is eight bytes somewhere in the image; the tool finds them by the first four.
#pragma once

#include <array>
#include <cstdint>

namespace octoskin {

/// The newest layout of the configuration block (node_config.hpp). A program that reads it also reads the
/// layout before it.
inline constexpr std::uint16_t kNodeConfigLayout = 5;

/// "OSKI", the layout, and the layout's complement (16 bits each), little-endian.
inline constexpr std::array<std::uint8_t, 4> kImageIdentityMagic{'O', 'S', 'K', 'I'};
inline constexpr std::size_t kImageIdentityBytes = 8;

[[nodiscard]] constexpr std::array<std::uint8_t, kImageIdentityBytes> image_identity(
    std::uint16_t layout) noexcept {
    const auto low = static_cast<std::uint8_t>(layout & 0xFFU);
    const auto high = static_cast<std::uint8_t>(layout >> 8U);
    return {kImageIdentityMagic[0],
            kImageIdentityMagic[1],
            kImageIdentityMagic[2],
            kImageIdentityMagic[3],
            low,
            high,
            static_cast<std::uint8_t>(~low & 0xFFU),
            static_cast<std::uint8_t>(~high & 0xFFU)};
}

}  // namespace octoskin
