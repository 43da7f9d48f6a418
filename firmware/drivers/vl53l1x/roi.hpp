// Regions of interest on the 16 x 16 SPAD array. Rows and columns follow ST's drawing (UM2555 section 2): row
// 0 is the top, column 0 the left. The rig defines how the drawing is oriented in the world.
#pragma once

#include <cstdint>

#include "common/config/node_config.hpp"

namespace octoskin::vl53l1x {

inline constexpr int kSpadRows = 16;
inline constexpr int kSpadColumns = 16;
inline constexpr int kRoiSideMin = 4;  ///< the device raises a smaller side to 4 (UM2510 3.6.5)

struct SpadPosition {
    int row = 0;     ///< 0..15
    int column = 0;  ///< 0..15
    friend constexpr bool operator==(const SpadPosition&, const SpadPosition&) = default;
};

/// SPAD number: the upper half counts upwards from 128, column by column; the lower half downwards from 127.
[[nodiscard]] constexpr std::uint8_t spad_number(SpadPosition spad) noexcept {
    return static_cast<std::uint8_t>(spad.row < 8 ? 128 + 8 * spad.column + spad.row
                                                  : 127 - 8 * spad.column - (spad.row - 8));
}

[[nodiscard]] constexpr SpadPosition spad_position(std::uint8_t number) noexcept {
    if (number >= 128) return {.row = (number - 128) % 8, .column = (number - 128) / 8};
    return {.row = 8 + (127 - number) % 8, .column = (127 - number) / 8};
}

/// Rows and columns from first to last, both included. May extend beyond the array.
struct SpadArea {
    SpadPosition first;
    SpadPosition last;
    friend constexpr bool operator==(const SpadArea&, const SpadArea&) = default;
};

/// The area of a region. The centre of an even side is the SPAD to the right of, or above, its middle
/// (UM2555).
[[nodiscard]] constexpr SpadArea covered_area(const Roi& roi) noexcept {
    const SpadPosition centre = spad_position(roi.centre_spad);
    const int left = centre.column - roi.width / 2;
    const int bottom = centre.row + roi.height / 2;
    return {.first = {.row = bottom - roi.height + 1, .column = left},
            .last = {.row = bottom, .column = left + roi.width - 1}};
}

/// True if the device ranges with this region: sides of 4..16, entirely on the array. Otherwise the device
/// returns range status 13.
[[nodiscard]] constexpr bool is_supported(const Roi& roi) noexcept {
    if (roi.width < kRoiSideMin || roi.width > kSpadColumns) return false;
    if (roi.height < kRoiSideMin || roi.height > kSpadRows) return false;
    const SpadArea area = covered_area(roi);
    return area.first.row >= 0 && area.last.row < kSpadRows && area.first.column >= 0 &&
           area.last.column < kSpadColumns;
}

/// ROI_CONFIG__USER_ROI_REQUESTED_GLOBAL_XY_SIZE: height - 1 in bits 7:4, width - 1 in bits 3:0.
[[nodiscard]] constexpr std::uint8_t size_register(const Roi& roi) noexcept {
    return static_cast<std::uint8_t>(((roi.height - 1U) << 4U) | (roi.width - 1U));
}

}  // namespace octoskin::vl53l1x
