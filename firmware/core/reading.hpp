// One accepted reading on its way from a sensor to the bus.
#pragma once

#include <cstdint>

#include "common/time.hpp"

namespace octoskin::node {

struct Reading {
    std::uint8_t zone = 0;
    std::uint8_t device_status = 0;  ///< as it goes on the wire: 19 for code 9 with stream count 0
    std::int16_t range_mm = 0;       ///< negative for a near target, by the sensor's offset error
    std::uint16_t sigma_quarter_mm = 0;
    std::uint16_t peak_signal = 0;  ///< 9.7 Mcps
    std::uint16_t ambient = 0;      ///< 9.7 Mcps
    NodeTime capture;               ///< middle of the ranging window
    Microseconds capture_bound{0};  ///< bound on the error of `capture`
};

/// The range for the wire's unsigned field: a negative one is sent as 0.
[[nodiscard]] constexpr std::uint16_t range_on_wire(const Reading& reading) noexcept {
    return reading.range_mm < 0 ? std::uint16_t{0} : static_cast<std::uint16_t>(reading.range_mm);
}

}  // namespace octoskin::node
