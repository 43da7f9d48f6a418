// Duration and period of a ranging, computed from the registers.
#pragma once

#include "common/time.hpp"
#include "hw/sim/vl53l1x/register_map.hpp"
#include "hw/sim/vl53l1x/sensor_traits.hpp"

namespace octoskin::sim {

/// The guard between a ranging and the next slot (UM2510 3.3; ST's full API 2.3.3 refuses to start with less
/// than 4 ms).
inline constexpr Microseconds kSlotGuard{4000};

/// Properties that differ between parts.
struct SensorPart {
    /// RESULT__OSC_CALIBRATE_VAL; real parts read 36 or 37, 30..45 are modelled. 0: not calibrated yet.
    std::uint16_t osc_calibrate = 0x25;
    /// The slow oscillator is faster than its calibration by this factor: a period is shorter by it. Public
    /// drivers compensate 1.055 to 1.075.
    double slow_clock_factor = 1.064;
    /// Variation of the slow oscillator: at every eighth range its rate changes by up to this share.
    double slow_clock_wander = 0.0;
    std::uint8_t optical_centre_spad = 199;
    Microseconds boot_time{1000};  ///< at most 1.2 ms (DS12385, 2.6.1)
    Microseconds slot_guard = kSlotGuard;
    /// Time from the begin of a range to its window. The time that a range takes beyond its budget is not
    /// public.
    Microseconds range_overhead{0};
    double crosstalk_kcps = 0.0;  ///< from the cover glass, per SPAD
    /// Whether a soft reset restores the default address at its begin (true) or at its end; no public
    /// document states it.
    bool forgets_address_as_soft_reset_begins = false;
    /// Whether a start in the present mode restarts the period; no public document states it. ST's full API
    /// writes a start with every clear.
    bool is_restarted_by_start = true;
    SensorTraits traits{};
};

/// Spread of the slow oscillators of a reel of parts: each has a factor between these.
struct SlowClockSpread {
    double factor_min = 1.04;
    double factor_max = 1.09;
};

struct RangingTiming {
    Microseconds overhead{0};  ///< from the start of a ranging to its window
    Microseconds budget{0};    ///< length of its window
    Microseconds slot{0};      ///< the inter-measurement register, in the simulation's time
    /// From one start to the next in timed mode: the slot, or as many slots as budget + guard or overhead
    /// need, because a slot that is too early is missed.
    Microseconds period{0};
};

/// Budget: the nominal one of ST's table for the mode (VCSEL period B) and time-out A; for any other value,
/// the time of both time-outs in macro periods plus the overhead by ST's and Pololu's drivers. Slot: the
/// inter-measurement register in ticks of the part's own oscillator.
[[nodiscard]] RangingTiming ranging_timing(const Registers& registers, const SensorPart& part);

}  // namespace octoskin::sim
