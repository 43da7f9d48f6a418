// The registers used by this driver, under the datasheet's names. ST writes two underscores between block and
// field; C++ reserves such names, so there is one here. Sources: VL53L1X datasheet DS12385 rev 7, ST's full
// API (STSW-IMG007) register map.
#pragma once

#include <cstdint>

namespace octoskin::vl53l1x::reg {

/// 16-bit index, sent most significant byte first. Wider quantities are stored MSB first at consecutive
/// indices.
using Index = std::uint16_t;

inline constexpr Index SOFT_RESET = 0x0000;
inline constexpr Index I2C_SLAVE_DEVICE_ADDRESS = 0x0001;
inline constexpr Index VHV_CONFIG_TIMEOUT_MACROP_LOOP_BOUND = 0x0008;
inline constexpr Index VHV_CONFIG_INIT = 0x000B;
inline constexpr Index ALGO_CROSSTALK_COMPENSATION_PLANE_OFFSET_KCPS = 0x0016;
inline constexpr Index ALGO_CROSSTALK_COMPENSATION_X_PLANE_GRADIENT_KCPS = 0x0018;
inline constexpr Index ALGO_CROSSTALK_COMPENSATION_Y_PLANE_GRADIENT_KCPS = 0x001A;
inline constexpr Index ALGO_PART_TO_PART_RANGE_OFFSET_MM = 0x001E;
inline constexpr Index MM_CONFIG_INNER_OFFSET_MM = 0x0020;
inline constexpr Index MM_CONFIG_OUTER_OFFSET_MM = 0x0022;
inline constexpr Index PAD_I2C_HV_CONFIG = 0x002D;
inline constexpr Index PAD_I2C_HV_EXTSUP_CONFIG = 0x002E;
inline constexpr Index GPIO_HV_PAD_CTRL = 0x002F;
inline constexpr Index GPIO_HV_MUX_CTRL = 0x0030;
inline constexpr Index GPIO_TIO_HV_STATUS = 0x0031;
inline constexpr Index SYSTEM_INTERRUPT_CONFIG_GPIO = 0x0046;
inline constexpr Index PHASECAL_CONFIG_TIMEOUT_MACROP = 0x004B;
inline constexpr Index DSS_CONFIG_ROI_MODE_CONTROL = 0x004F;
inline constexpr Index RANGE_CONFIG_TIMEOUT_MACROP_A = 0x005E;
inline constexpr Index RANGE_CONFIG_VCSEL_PERIOD_A = 0x0060;
inline constexpr Index RANGE_CONFIG_TIMEOUT_MACROP_B = 0x0061;
inline constexpr Index RANGE_CONFIG_VCSEL_PERIOD_B = 0x0063;
inline constexpr Index RANGE_CONFIG_SIGMA_THRESH = 0x0064;
inline constexpr Index RANGE_CONFIG_MIN_COUNT_RATE_RTN_LIMIT_MCPS = 0x0066;
inline constexpr Index RANGE_CONFIG_VALID_PHASE_HIGH = 0x0069;
inline constexpr Index SYSTEM_INTERMEASUREMENT_PERIOD = 0x006C;
inline constexpr Index SYSTEM_THRESH_HIGH = 0x0072;
inline constexpr Index SYSTEM_THRESH_LOW = 0x0074;
inline constexpr Index SD_CONFIG_WOI_SD0 = 0x0078;
inline constexpr Index SD_CONFIG_INITIAL_PHASE_SD0 = 0x007A;
inline constexpr Index ROI_CONFIG_USER_ROI_CENTRE_SPAD = 0x007F;
inline constexpr Index ROI_CONFIG_USER_ROI_REQUESTED_GLOBAL_XY_SIZE = 0x0080;
inline constexpr Index SYSTEM_INTERRUPT_CLEAR = 0x0086;
inline constexpr Index SYSTEM_MODE_START = 0x0087;
inline constexpr Index RESULT_RANGE_STATUS = 0x0089;
inline constexpr Index RESULT_OSC_CALIBRATE_VAL = 0x00DE;
inline constexpr Index FIRMWARE_SYSTEM_STATUS = 0x00E5;
inline constexpr Index IDENTIFICATION_MODEL_ID = 0x010F;
inline constexpr Index ROI_CONFIG_MODE_ROI_CENTRE_SPAD = 0x013E;

}  // namespace octoskin::vl53l1x::reg
