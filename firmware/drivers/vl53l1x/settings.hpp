// Settings applied between initialising and starting a sensor.
#pragma once

#include <cstdint>

#include "common/config/node_config.hpp"

namespace octoskin::vl53l1x {

/// The sensor's part of the configuration block. The driver applies mode, budget, period, the first zone,
/// limits, offset, crosstalk and the gain factor (range * 2011 / 2048, as in ST's full API).
using Settings = SensorConfig;

/// ALGO__PART_TO_PART_RANGE_OFFSET_MM: signed 13 bits, 11.2 mm.
inline constexpr std::int16_t kOffsetQuarterMmMin = -4096;
inline constexpr std::int16_t kOffsetQuarterMmMax = 4095;
[[nodiscard]] constexpr bool is_offset_supported(std::int16_t quarter_mm) noexcept {
    return quarter_mm >= kOffsetQuarterMmMin && quarter_mm <= kOffsetQuarterMmMax;
}

/// True if a sensor supports the settings: a budget of the mode's table, a period of at least the budget plus
/// 5 ms, at least one zone and every zone on the SPAD array, an offset within its 13 bits.
[[nodiscard]] bool is_supported(const Settings& settings) noexcept;

/// Condition of the interrupt, instead of every sample (SYSTEM__INTERRUPT_CONFIG_GPIO bits 1:0).
enum class RangeWindow : std::uint8_t { below_low = 0, above_high = 1, outside = 2, inside = 3 };
struct RangeThreshold {
    std::uint16_t low_mm = 0;
    std::uint16_t high_mm = 0;
    RangeWindow window = RangeWindow::inside;
    bool fires_without_target = false;  ///< also for a range without a target (bit 6)
};

}  // namespace octoskin::vl53l1x
