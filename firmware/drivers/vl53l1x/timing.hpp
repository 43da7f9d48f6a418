// Distance mode, timing budget and inter-measurement period as register values.
#pragma once

#include <cstdint>
#include <optional>

#include "common/config/node_config.hpp"
#include "common/time.hpp"

namespace octoskin::vl53l1x {

/// Register values of a distance mode. Short and long: ST ULD 3.5.2, VL53L1X_SetDistanceMode; medium: ST's
/// full API.
struct ModeRegisters {
    std::uint8_t phasecal_timeout = 0;  ///< 0x4B; ST's driver identifies the mode by it
    std::uint8_t vcsel_period_a = 0;    ///< 0x60
    std::uint8_t vcsel_period_b = 0;    ///< 0x63
    std::uint8_t valid_phase_high = 0;  ///< 0x69, 5.3 fixed point, 0.2 m per unit
    std::uint16_t woi = 0;              ///< 0x78, 0x79
    std::uint16_t initial_phase = 0;    ///< 0x7A, 0x7B
};
[[nodiscard]] const ModeRegisters& mode_registers(DistanceMode mode) noexcept;

/// The mode identified by PHASECAL_CONFIG__TIMEOUT_MACROP; empty if unknown.
[[nodiscard]] std::optional<DistanceMode> marked_mode(std::uint8_t phasecal_timeout) noexcept;

/// RANGE_CONFIG__TIMEOUT_MACROP_A and _B, encoded as (low byte << high byte) + 1 macro periods.
struct RangeTimeouts {
    std::uint16_t a = 0;
    std::uint16_t b = 0;
    friend constexpr bool operator==(const RangeTimeouts&, const RangeTimeouts&) = default;
};
/// Empty unless the mode supports the budget: 33, 50, 100, 200 or 500 ms; 20 ms in short and long mode, 15 ms
/// in short mode only.
[[nodiscard]] std::optional<RangeTimeouts> range_timeouts(DistanceMode mode,
                                                          std::uint16_t budget_ms) noexcept;
/// The budget for a value of time-out A, in any mode: each value occurs once. Empty if unknown.
[[nodiscard]] std::optional<std::uint16_t> budget_of_timeout_a(std::uint16_t timeout_a) noexcept;

/// With a period shorter than budget + 4 ms the sensor misses every second slot, which halves the rate
/// (UM2510 3.3; 4 ms from UM2356 rev 2). 1 ms is added for the error of the sensor's clock.
inline constexpr std::uint16_t kPeriodMarginMs = 5;
[[nodiscard]] constexpr bool is_period_long_enough(std::uint16_t budget_ms,
                                                   std::uint16_t period_ms) noexcept {
    return period_ms >= std::uint32_t{budget_ms} + kPeriodMarginMs;
}

/// SYSTEM__INTERMEASUREMENT_PERIOD for a nominal period: (oscillator & 0x3FF) * ms * 1.075, truncated (ST ULD
/// 3.5.2). Empty if the oscillator value is 0 (not calibrated yet), or if the period is not positive or does
/// not fit. The real period differs by several per cent: use it for scheduling, not to measure time.
[[nodiscard]] std::optional<std::uint32_t> period_register(std::uint16_t oscillator,
                                                           Microseconds nominal) noexcept;

/// Change of the period per step of that register: 25 us at the usual oscillator value of 37. Empty if the
/// value is 0.
[[nodiscard]] std::optional<Nanoseconds> period_step(std::uint16_t oscillator) noexcept;

}  // namespace octoskin::vl53l1x
