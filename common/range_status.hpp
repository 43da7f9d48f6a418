// The meaning of a VL53L1X's range status and what a mapper may do with it: one table for firmware and host.
#pragma once

#include <cstdint>

namespace octoskin {

/// The status numbers of ST's user manuals (UM2356, UM2510).
enum class RangeStatus : std::uint8_t {
    valid = 0,
    sigma_fail = 1,
    signal_fail = 2,
    valid_min_clipped = 3,
    out_of_bounds = 4,
    hardware_fail = 5,
    valid_no_wrap_check = 6,
    wrapped_target = 7,
    processing_fail = 8,
    crosstalk_signal_fail = 9,
    synchronisation = 10,
    merged_pulse = 11,
    weak_target = 12,
    roi_misfit = 13,
    range_invalid = 14,
    none = 255,
};

/// What a reading with a given status may change in the map.
enum class RangeUse : std::uint8_t {
    hit,        ///< an endpoint, and free space before it
    no_return,  ///< no endpoint; may clear space up to a configured, capped distance
    nothing,    ///< neither
};

inline constexpr std::uint8_t kDeviceStatusesDefined = 24;  ///< 0..23; the rest of the 5 bits is undefined
inline constexpr std::uint8_t kDeviceStatusNoTarget = 4;
inline constexpr std::uint8_t kDeviceStatusComplete = 9;
inline constexpr std::uint8_t kDeviceStatusCompleteNoWrapCheck = 19;

struct RangeStatusEntry {
    RangeStatus status = RangeStatus::none;
    RangeUse use = RangeUse::nothing;
    const char* text = "";
};

/// The entry of any of the 32 device codes (bits 4:0 of RESULT__RANGE_STATUS; the caller masks them). Only
/// code 9 is a hit: code 19 (first range, no wrap check) and code 8 (clipped at the minimum) give no reliable
/// distance. Only code 4 may clear space. Source: VL53L1X full API and ULD status tables; UM2356 table 4 for
/// the use.
[[nodiscard]] const RangeStatusEntry& range_status(std::uint8_t device_code) noexcept;

}  // namespace octoskin
