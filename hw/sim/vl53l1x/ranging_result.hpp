// One ranging's result: the registers at its begin, the return of the optics, and the registers that the
// device writes.
#pragma once

#include <cstdint>

#include "common/config/node_config.hpp"
#include "hw/sim/vl53l1x/register_map.hpp"
#include "hw/sim/vl53l1x/scene.hpp"

namespace octoskin::sim {

/// The region of interest in the registers.
[[nodiscard]] Roi region_of_interest(const Registers& registers) noexcept;
/// False if it reaches beyond the 16 x 16 array: the device then reports status 13.
[[nodiscard]] bool is_on_array(const Roi& roi) noexcept;

/// Ratio of a region's signal limit to that of the whole array: the square root of the share of SPADs,
/// because fewer SPADs also count less noise, but at least 0.39. The value is chosen: with the optics of
/// hw/sim/camera, the ratios of the ranges at which half of the rangings fail agree within 15 % with those of
/// the datasheet's greatest ranges (DS12385 rev 7, table 9). For small zones and dark targets the scene adds
/// a further factor.
[[nodiscard]] double signal_limit_share(const Roi& roi) noexcept;

/// Limits and corrections of a ranging.
struct RangingConfig {
    Roi roi{};
    double range_max_m = 0.0;        ///< of the valid phase: beyond it the device reports status 5
    double offset_m = 0.0;           ///< added to the true range: the configured offset minus the part's own
    double crosstalk_kcps = 0.0;     ///< of the cover glass, per SPAD
    double compensation_kcps = 0.0;  ///< the configured value
    double sigma_limit_m = 0.0;
    double signal_limit_mcps = 0.0;        ///< of this region: the register has the limit of the whole array
    std::uint8_t interrupt_condition = 0;  ///< SYSTEM__INTERRUPT_CONFIG_GPIO
    std::uint16_t threshold_low_mm = 0;
    std::uint16_t threshold_high_mm = 0;
};
[[nodiscard]] RangingConfig ranging_config(const Registers& registers, double crosstalk_kcps = 0.0);

/// The device code (RESULT__RANGE_STATUS bits 4:0) of a ranging.
[[nodiscard]] std::uint8_t device_status(const RangingConfig& config, const RangingReturn& seen);

struct RangingResult {
    std::uint8_t range_status = 0;  ///< RESULT__RANGE_STATUS, high bits included
    std::uint8_t stream_count = 0;
    /// Signed. With an error status it is a plausible number: users who ignore the status see ghosts at 100
    /// to 500 mm.
    std::int16_t range_mm = 0;
};
/// The range that the device reports, mm; a function of the arguments only. Uncompensated crosstalk shortens
/// it by its share of the signal, as ST's calibration assumes (ULD 3.5.2, VL53L1X_CalibrateXtalk).
[[nodiscard]] std::int16_t reported_range_mm(const RangingConfig& config, const RangingReturn& seen,
                                             std::uint32_t ranging_index);

/// Writes 0x0088..0x009F in the device's own formats, at once.
void write_result(Registers& registers, const RangingConfig& config, const RangingReturn& seen,
                  const RangingResult& result);

/// Whether this result fires the interrupt. Rate conditions (bits 3:2) are not modelled: no public document
/// states how they combine.
[[nodiscard]] bool fires_interrupt(const RangingConfig& config, const RangingResult& result);

}  // namespace octoskin::sim
