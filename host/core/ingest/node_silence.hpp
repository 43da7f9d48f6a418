// What is missing from the sensors of a usable node.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/time.hpp"
#include "host/core/ingest/range_gate.hpp"
#include "host/core/rig/host_rig.hpp"

namespace octoskin {

/// The worst condition that holds for a sensor.
enum class SensorSilence : std::uint8_t {
    none,         ///< none, or too little data to decide yet
    mostly_lost,  ///< over half of the readings that its node sent within about 3 s did not arrive
    /// No reading for a second and for three periods, although its node reports that it ranges and has sent
    /// more readings meanwhile than can be on their way.
    no_readings,
    unheard,  ///< is_unheard()
};

/// Neither a reading nor SENSOR_HEALTH of the sensor arrived for SensorRecord::kUnheardAfter, while its node
/// was usable throughout: the sensor's condition is unknown. False while the host time is unknown.
[[nodiscard]] bool is_unheard(const SensorRecord& sensor, std::optional<HostTime> now);

/// A sensor is mostly lost if more than this share of its sent readings does not arrive.
inline constexpr double kMostlyLost = 0.5;
/// `period`: as configured.
[[nodiscard]] SensorSilence silence_of(const SensorRecord& sensor, Nanoseconds period, HostTime now);

struct NodeSilence {
    struct OfSensor {
        std::size_t index = 0;
        SensorSilence what = SensorSilence::none;
    };
    /// A condition of the whole node: the node's other sensors have it, too. Entries in `sensors` beside it
    /// are worse.
    SensorSilence of_all = SensorSilence::none;
    /// Sensors that have a condition alone. A sensor is in neither field while it is undecided whether it is
    /// alone, because data from the other sensors have just resumed.
    std::vector<OfSensor> sensors;
};
/// For a node of the rig that is usable at `now`. O(sensors squared) if some are silent.
[[nodiscard]] NodeSilence silence_of(const RangeGate& ranges, const HostNode& node, HostTime now);

}  // namespace octoskin
