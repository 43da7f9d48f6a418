// The VL53L1X's registers in the simulated part. Separate from the driver's own list, so that a wrong address
// on either side is detected. Names and values: datasheet DS12385 rev 7, ST's full API (STSW-IMG007), and a
// dump of one real part.
#pragma once

#include <array>
#include <cstdint>

namespace octoskin::sim::reg {

inline constexpr std::uint16_t kSoftReset = 0x0000;
inline constexpr std::uint16_t kI2cAddress = 0x0001;
inline constexpr std::uint16_t kFastOscFrequency = 0x0006;
inline constexpr std::uint16_t kCrosstalkPlaneOffset = 0x0016;
inline constexpr std::uint16_t kPartToPartOffset = 0x001E;
inline constexpr std::uint16_t kGpioMux = 0x0030;
inline constexpr std::uint16_t kGpioStatus = 0x0031;
inline constexpr std::uint16_t kInterruptConfig = 0x0046;
inline constexpr std::uint16_t kTimeoutA = 0x005E;
inline constexpr std::uint16_t kVcselPeriodA = 0x0060;
inline constexpr std::uint16_t kTimeoutB = 0x0061;
inline constexpr std::uint16_t kVcselPeriodB = 0x0063;
inline constexpr std::uint16_t kSigmaThreshold = 0x0064;
inline constexpr std::uint16_t kSignalThreshold = 0x0066;
inline constexpr std::uint16_t kValidPhaseHigh = 0x0069;
inline constexpr std::uint16_t kInterMeasurement = 0x006C;
inline constexpr std::uint16_t kGroupedHold0 = 0x0071;
inline constexpr std::uint16_t kThresholdHigh = 0x0072;
inline constexpr std::uint16_t kThresholdLow = 0x0074;
inline constexpr std::uint16_t kGroupedHold1 = 0x007C;
inline constexpr std::uint16_t kRoiCentre = 0x007F;
inline constexpr std::uint16_t kRoiSize = 0x0080;
inline constexpr std::uint16_t kSequenceConfig = 0x0081;
inline constexpr std::uint16_t kGroupedHold = 0x0082;
inline constexpr std::uint16_t kFirmwareEnable = 0x0085;
inline constexpr std::uint16_t kInterruptClear = 0x0086;
inline constexpr std::uint16_t kModeStart = 0x0087;
inline constexpr std::uint16_t kResultInterruptStatus = 0x0088;
inline constexpr std::uint16_t kResultRangeStatus = 0x0089;
inline constexpr std::uint16_t kResultStreamCount = 0x008B;
inline constexpr std::uint16_t kResultSpads = 0x008C;
inline constexpr std::uint16_t kResultPeakSignal = 0x008E;
inline constexpr std::uint16_t kResultAmbient = 0x0090;
inline constexpr std::uint16_t kResultSigma = 0x0092;
inline constexpr std::uint16_t kResultPhase = 0x0094;
inline constexpr std::uint16_t kResultRange = 0x0096;
inline constexpr std::uint16_t kResultCorrectedSignal = 0x0098;
inline constexpr std::uint16_t kResultLast = 0x009F;
inline constexpr std::uint16_t kOscCalibrate = 0x00DE;
inline constexpr std::uint16_t kSystemStatus = 0x00E5;
inline constexpr std::uint16_t kModelId = 0x010F;
inline constexpr std::uint16_t kRoiModeCentre = 0x013E;

inline constexpr std::uint16_t kCount = 0x0200;

}  // namespace octoskin::sim::reg

namespace octoskin::sim {

using Registers = std::array<std::uint8_t, reg::kCount>;

/// The content after power-up, XSHUT or soft reset, without the values that differ between parts.
[[nodiscard]] const Registers& reset_registers();

[[nodiscard]] constexpr std::uint16_t read16(const Registers& registers, std::uint16_t index) {
    return static_cast<std::uint16_t>((registers.at(index) << 8U) | registers.at(index + 1U));
}
constexpr void write16(Registers& registers, std::uint16_t index, std::uint16_t value) {
    registers.at(index) = static_cast<std::uint8_t>(value >> 8U);
    registers.at(index + 1U) = static_cast<std::uint8_t>(value & 0xFFU);
}
[[nodiscard]] constexpr std::uint32_t read32(const Registers& registers, std::uint16_t index) {
    return (static_cast<std::uint32_t>(read16(registers, index)) << 16U) |
           read16(registers, static_cast<std::uint16_t>(index + 2U));
}

}  // namespace octoskin::sim
