#include "hw/sim/vl53l1x/ranging_result.hpp"

#include <algorithm>
#include <cmath>

namespace octoskin::sim {
namespace {

constexpr std::uint8_t kStatusNoTarget = 4;
constexpr std::uint8_t kStatusPhase = 5;
constexpr std::uint8_t kStatusSigma = 6;
constexpr std::uint8_t kStatusComplete = 9;
constexpr std::uint8_t kStatusRoiClip = 13;

constexpr double kSigmaScale = 4.0;     // 14.2 mm
constexpr double kRateScale = 128.0;    // 9.7 Mcps
constexpr double kSpadScale = 256.0;    // 8.8
constexpr double kPhaseScale = 2048.0;  // 5.11
constexpr double kPhaseUnit_m = 0.2;
constexpr double kCrosstalkScale = 512.0;  // 7.9 kcps per SPAD
constexpr double kActiveSpads = 0.8;       // of those in the region: every part has some disabled SPADs

double active_spads(const Roi& roi) {
    return roi.width * roi.height * kActiveSpads;
}

std::uint16_t fixed_point(double value, double scale) {
    return static_cast<std::uint16_t>(std::clamp(std::round(value * scale), 0.0, 65535.0));
}

// RANGE_CONFIG__VALID_PHASE_HIGH, 5.3 fixed point, 0.2 m a unit (preset comments of ST's full API).
double valid_range_m(std::uint8_t valid_phase_high) {
    return valid_phase_high / 8.0 * kPhaseUnit_m;
}

// ALGO__PART_TO_PART_RANGE_OFFSET_MM: signed 13 bits, 11.2.
double offset_m(std::uint16_t raw) {
    const int value = raw & 0x1FFF;
    return (value >= 0x1000 ? value - 0x2000 : value) / 4.0 * 1e-3;
}

}  // namespace

Roi region_of_interest(const Registers& registers) noexcept {
    const std::uint8_t size = registers.at(reg::kRoiSize);
    // The device's firmware raises a side below 4 to 4 (AN5191).
    const auto side = [](unsigned nibble) { return static_cast<std::uint8_t>(std::max(nibble + 1U, 4U)); };
    return {registers.at(reg::kRoiCentre), side(size & 0x0FU), side(size >> 4U)};
}

bool is_on_array(const Roi& roi) noexcept {
    // SPAD numbers: rows 0..7 hold 128 + 8 column + row, rows 8..15 hold 127 - 8 column - (row - 8) (UM2555).
    const bool is_upper = roi.centre_spad >= 128;
    const int number = is_upper ? roi.centre_spad - 128 : 127 - roi.centre_spad;
    const int column = number / 8;
    const int row = number % 8 + (is_upper ? 0 : 8);
    // For an even side, the centre is the SPAD right of and above the middle.
    const int left = column - roi.width / 2;
    const int bottom = row + roi.height / 2;
    return left >= 0 && left + roi.width <= 16 && bottom <= 15 && bottom - roi.height + 1 >= 0;
}

double signal_limit_share(const Roi& roi) noexcept {
    constexpr double kArraySpads = 256.0;
    constexpr double kLeast = 0.39;
    return std::max(std::sqrt(roi.width * roi.height / kArraySpads), kLeast);
}

RangingConfig ranging_config(const Registers& registers, double crosstalk_kcps) {
    // The optics have the error that the factory offset corrects, so that the factory offset gives the true
    // range.
    const double factory_offset_m = offset_m(read16(reset_registers(), reg::kPartToPartOffset));
    const Roi roi = region_of_interest(registers);
    return {
        .roi = roi,
        .range_max_m = valid_range_m(registers.at(reg::kValidPhaseHigh)),
        .offset_m = offset_m(read16(registers, reg::kPartToPartOffset)) - factory_offset_m,
        .crosstalk_kcps = crosstalk_kcps,
        .compensation_kcps = read16(registers, reg::kCrosstalkPlaneOffset) / kCrosstalkScale,
        .sigma_limit_m = read16(registers, reg::kSigmaThreshold) / kSigmaScale * 1e-3,
        .signal_limit_mcps = read16(registers, reg::kSignalThreshold) / kRateScale * signal_limit_share(roi),
        .interrupt_condition = registers.at(reg::kInterruptConfig),
        .threshold_low_mm = read16(registers, reg::kThresholdLow),
        .threshold_high_mm = read16(registers, reg::kThresholdHigh)};
}

std::uint8_t device_status(const RangingConfig& config, const RangingReturn& seen) {
    if (!is_on_array(config.roi)) return kStatusRoiClip;
    if (!seen.range_m || seen.peak_signal_mcps < config.signal_limit_mcps) return kStatusNoTarget;
    if (*seen.range_m > config.range_max_m) return kStatusPhase;
    if (seen.sigma_m > config.sigma_limit_m) return kStatusSigma;
    return kStatusComplete;
}

std::int16_t reported_range_mm(const RangingConfig& config, const RangingReturn& seen,
                               std::uint32_t ranging_index) {
    if (!seen.range_m) return static_cast<std::int16_t>(100 + ranging_index * 37 % 401);
    // Beyond the window the phase wraps round.
    const double range_m = config.range_max_m > 0.0 ? std::fmod(*seen.range_m, config.range_max_m) : 0.0;
    const double unwrapped_m = *seen.range_m > config.range_max_m ? range_m : *seen.range_m;
    const double excess_kcps = (config.crosstalk_kcps - config.compensation_kcps) * active_spads(config.roi);
    const double signal_kcps = seen.peak_signal_mcps * 1e3;
    const double share = signal_kcps > 0.0 ? excess_kcps / signal_kcps : 0.0;
    const double range_mm = std::round((unwrapped_m * (1.0 - share) + config.offset_m) * 1e3);
    return static_cast<std::int16_t>(std::clamp(range_mm, -32768.0, 32767.0));
}

void write_result(Registers& registers, const RangingConfig& config, const RangingReturn& seen,
                  const RangingResult& result) {
    const double phase = std::max<int>(result.range_mm, 0) * 1e-3 / kPhaseUnit_m;
    registers.at(reg::kResultInterruptStatus) = 0x20;
    registers.at(reg::kResultRangeStatus) = result.range_status;
    registers.at(reg::kResultRangeStatus + 1U) = 0;
    registers.at(reg::kResultStreamCount) = result.stream_count;
    write16(registers, reg::kResultSpads, fixed_point(active_spads(config.roi), kSpadScale));
    write16(registers, reg::kResultPeakSignal, fixed_point(seen.peak_signal_mcps, kRateScale));
    write16(registers, reg::kResultAmbient, fixed_point(seen.ambient_mcps, kRateScale));
    write16(registers, reg::kResultSigma, fixed_point(seen.sigma_m * 1e3, kSigmaScale));
    write16(registers, reg::kResultPhase, fixed_point(phase, kPhaseScale));
    write16(registers, reg::kResultRange, static_cast<std::uint16_t>(result.range_mm));
    const double compensated_mcps =
        seen.peak_signal_mcps - config.compensation_kcps * active_spads(config.roi) * 1e-3;
    write16(registers, reg::kResultCorrectedSignal, fixed_point(compensated_mcps, kRateScale));
}

bool fires_interrupt(const RangingConfig& config, const RangingResult& result) {
    constexpr unsigned kOnNewSample = 0x20;
    constexpr unsigned kOnNoTarget = 0x40;
    const unsigned condition = config.interrupt_condition;
    if ((condition & kOnNewSample) != 0) return true;
    if ((result.range_status & 0x1FU) == kStatusNoTarget) return (condition & kOnNoTarget) != 0;
    const bool is_below = result.range_mm < config.threshold_low_mm;
    const bool is_above = result.range_mm > config.threshold_high_mm;
    switch (condition & 3U) {
        case 0:
            return is_below;
        case 1:
            return is_above;
        case 2:
            return is_below || is_above;
        default:
            return !is_below && !is_above;
    }
}

}  // namespace octoskin::sim
