// The 91 bytes at 0x2D..0x87 that ST's drivers write before the first range: ST ULD 3.5.2,
// VL51L1X_DEFAULT_CONFIGURATION (identical in ULD 3.5.0, 3.5.1 and 1.0.1). They select long mode, 100 ms
// budget, 100 ms period and 16 x 16 SPADs. ST marks most of them as not for the user to change.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/drivers/vl53l1x/registers.hpp"

namespace octoskin::vl53l1x {

inline constexpr reg::Index kDefaultConfigurationFirst = reg::PAD_I2C_HV_CONFIG;

inline constexpr std::array<std::uint8_t, 91> kDefaultConfiguration{
    // clang-format off
    // I2C and GPIO pads, interrupt pin (0x30: active high), pin status
    /* 0x2D */ 0x00, 0x00, 0x00, 0x01, 0x02, 0x00,
    // analogue, sigma estimator, crosstalk, range ignore, consistency check
    /* 0x33 */ 0x02, 0x08, 0x00, 0x08, 0x10, 0x01, 0x01, 0x00, 0x00, 0x00, 0x00, 0xFF, 0x00, 0x0F, 0x00,
    // reset stages, stream; interrupt on every new sample (0x46)
    /* 0x42 */ 0x00, 0x00, 0x00, 0x00, 0x20,
    // VCSEL, phase calibration (0x4B: long mode), dynamic SPAD selection
    /* 0x47 */ 0x0B, 0x00, 0x00, 0x02, 0x0A, 0x21, 0x00, 0x00, 0x05, 0x00, 0x00, 0x00, 0x00,
    /* 0x54 */ 0xC8, 0x00, 0x00, 0x38, 0xFF, 0x01,
    // time-outs and VCSEL periods. 0x5F was 0xDB before ULD 1.0.2; ST's own budget table has no entry for
    // that value.
    /* 0x5A */ 0x00, 0x08, 0x00, 0x00, 0x01, 0xCC, 0x0F, 0x01, 0xF1, 0x0D,
    // sigma limit 90 mm, signal limit 1.0 Mcps, valid phase 1.0..23.0
    /* 0x64 */ 0x01, 0x68, 0x00, 0x80, 0x08, 0xB8, 0x00, 0x00,
    // inter-measurement period: 100 ms at oscillator value 37; thresholds off
    /* 0x6C */ 0x00, 0x00, 0x0F, 0x89, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x01,
    // windows of interest and initial phases (long mode)
    /* 0x78 */ 0x0F, 0x0D, 0x0E, 0x0E, 0x00, 0x00, 0x02,
    // region of interest: SPAD 199, 16 x 16; sequence: VHV, phase calibration, DSS 1 and 2, range
    /* 0x7F */ 0xC7, 0xFF, 0x9B, 0x00, 0x00, 0x00, 0x01, 0x00, 0x00
    // clang-format on
};

/// Settings of the pads that depend on the board.
struct PadOptions {
    bool is_io_2v8 = true;                ///< SDA, SCL and GPIO1 are pulled up to AVDD rather than to 1.8 V
    bool is_interrupt_active_low = true;  ///< level of GPIO1 when data is ready
};

/// GPIO_HV_MUX__CTRL: bits 3:0 select the interrupt and must stay 1; bit 4 makes it active low.
[[nodiscard]] constexpr std::uint8_t interrupt_pin_control(bool is_active_low) noexcept {
    return is_active_low ? 0x11 : 0x01;
}

/// The byte for register `index`, 0x2D..0x87.
[[nodiscard]] constexpr std::uint8_t default_configuration(reg::Index index,
                                                           const PadOptions& pads) noexcept {
    switch (index) {
        case reg::PAD_I2C_HV_EXTSUP_CONFIG:
        case reg::GPIO_HV_PAD_CTRL:
            return pads.is_io_2v8 ? 0x01 : 0x00;
        case reg::GPIO_HV_MUX_CTRL:
            return interrupt_pin_control(pads.is_interrupt_active_low);
        default:
            return kDefaultConfiguration[index - kDefaultConfigurationFirst];
    }
}

}  // namespace octoskin::vl53l1x
