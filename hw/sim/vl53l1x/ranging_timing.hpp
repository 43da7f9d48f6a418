// How long a ranging takes and how often it comes, out of the registers that decide it.
#pragma once

#include "common/time.hpp"
#include "hw/sim/vl53l1x/register_map.hpp"
#include "hw/sim/vl53l1x/sensor_traits.hpp"

namespace octoskin::sim {

/// The guard between a ranging and the next slot (UM2510 3.3; ST's full API 2.3.3 refuses to start with less
/// than 4 ms).
inline constexpr Microseconds kSlotGuard{4000};

/// What differs from one part to the next.
struct SensorPart {
    /// RESULT__OSC_CALIBRATE_VAL; real parts read 36 or 37, 30..45 are modelled. 0: not calibrated yet.
    std::uint16_t osc_calibrate = 0x25;
    /// The slow oscillator is faster than its calibration says: a period comes out shorter by this factor.
    /// Public drivers compensate 1.055 to 1.075.
    double slow_clock_factor = 1.064;
    /// The slow oscillator does not keep its rate: every eighth range it is another one, by up to this share.
    double slow_clock_wander = 0.0;
    std::uint8_t optical_centre_spad = 199;
    Microseconds boot_time{1000};  ///< at most 1.2 ms (DS12385, 2.6.1)
    Microseconds slot_guard = kSlotGuard;
    /// A range begins so long before its window: what a range takes beyond its budget is not public.
    Microseconds range_overhead{0};
    double crosstalk_kcps = 0.0;  ///< what the cover glass sends back, per SPAD
    /// Whether a soft reset takes the address back when it begins or when it ends; nothing public says.
    bool forgets_address_as_soft_reset_begins = false;
    /// Whether a start in the mode that it is in begins its period anew; nothing public says. ST's full API
    /// writes one with every clear.
    bool is_restarted_by_start = true;
    SensorTraits traits{};
};

/// How fast the slow oscillators of a reel of parts are: of each somewhere between these.
struct SlowClockSpread {
    double factor_min = 1.04;
    double factor_max = 1.09;
};

struct RangingTiming {
    Microseconds overhead{0};  ///< from the start of a ranging to its window
    Microseconds budget{0};    ///< length of its window
    Microseconds slot{0};      ///< the inter-measurement register, by the simulation's clock
    /// From one start to the next in timed mode: the slot, or as many slots as budget + guard or overhead
    /// need, since a slot that comes too early is missed.
    Microseconds period{0};
};

/// Budget: the nominal one of ST's table for the mode (VCSEL period B) and time-out A; for any other value,
/// what both time-outs take in macro periods and what ST's and Pololu's drivers leave for the rest. Slot: the
/// inter-measurement register in ticks of the part's own oscillator.
[[nodiscard]] RangingTiming ranging_timing(const Registers& registers, const SensorPart& part);

}  // namespace octoskin::sim
