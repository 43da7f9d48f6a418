// One result of a VL53L1X, in the device's own units.
#pragma once

#include <cstdint>

namespace octoskin::vl53l1x {

/// The 17-byte block from 0x0089, unpacked. Formats: full API register_structs.h.
struct Measurement {
    std::uint8_t device_status = 0;  ///< bits 4:0 of RESULT__RANGE_STATUS
    std::uint8_t stream_count =
        0;  ///< 0, 1..255, then 128..255 again; 0 only for the first range after a start
    std::uint16_t effective_spads = 0;   ///< 8.8
    std::uint16_t peak_signal = 0;       ///< 9.7 Mcps
    std::uint16_t ambient = 0;           ///< 9.7 Mcps
    std::uint16_t sigma_quarter_mm = 0;  ///< 14.2 mm
    /// Crosstalk-corrected; gain factor applied if configured. A negative device offset can make the range of
    /// a near target negative.
    std::int16_t range_mm = 0;
    std::uint16_t corrected_signal = 0;  ///< 9.7 Mcps
    friend constexpr bool operator==(const Measurement&, const Measurement&) = default;
};

}  // namespace octoskin::vl53l1x
