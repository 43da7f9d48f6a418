// One ranging's result: what the registers asked for when it began, what the optics saw, what the device then
// writes.
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

/// A region's limits of signal by those of the whole array: fewer SPADs count less of what disturbs, too,
/// as the square root of their number, but never less than 0.39 of it. That is chosen: with the optics of
/// hw/sim/camera the ranges at which half of the rangings fail are to each other as the largest ones of the
/// datasheet (DS12385 rev 7, table 9) within 15 %; of small zones and dark targets with what the scene adds.
[[nodiscard]] double signal_limit_share(const Roi& roi) noexcept;

/// What a range is judged by and corrected with.
struct RangingConfig {
    Roi roi{};
    double range_max_m = 0.0;        ///< of the valid phase: beyond it the device reports status 5
    double offset_m = 0.0;           ///< added to the true range: the set offset less the part's own
    double crosstalk_kcps = 0.0;     ///< of the cover glass, per SPAD
    double compensation_kcps = 0.0;  ///< what the part is told that it is
    double sigma_limit_m = 0.0;
    double signal_limit_mcps = 0.0;        ///< of this region: the register's is that of the whole array
    std::uint8_t interrupt_condition = 0;  ///< SYSTEM__INTERRUPT_CONFIG_GPIO
    std::uint16_t threshold_low_mm = 0;
    std::uint16_t threshold_high_mm = 0;
};
[[nodiscard]] RangingConfig ranging_config(const Registers& registers, double crosstalk_kcps = 0.0);

/// The device code (RESULT__RANGE_STATUS bits 4:0) that a range ends in.
[[nodiscard]] std::uint8_t device_status(const RangingConfig& config, const RangingReturn& seen);

struct RangingResult {
    std::uint8_t range_status = 0;  ///< RESULT__RANGE_STATUS, high bits included
    std::uint8_t stream_count = 0;
    /// Signed. Where the status says that there is no range, a plausible number: ghosts at 100 to 500 mm are
    /// what users see who do not look at the status.
    std::int16_t range_mm = 0;
};
/// The range as the device would give it, in mm; a function of the arguments only. Crosstalk that is not
/// compensated shortens it by its share of the signal, which is what ST's calibration solves for (ULD 3.5.2,
/// VL53L1X_CalibrateXtalk).
[[nodiscard]] std::int16_t reported_range_mm(const RangingConfig& config, const RangingReturn& seen,
                                             std::uint32_t ranging_index);

/// Writes 0x0088..0x009F in the device's own formats, at once.
void write_result(Registers& registers, const RangingConfig& config, const RangingReturn& seen,
                  const RangingResult& result);

/// Whether this result fires the interrupt. Rate conditions (bits 3:2) are not modelled: nothing public says
/// how they combine.
[[nodiscard]] bool fires_interrupt(const RangingConfig& config, const RangingResult& result);

}  // namespace octoskin::sim
