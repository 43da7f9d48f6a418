// What does not come of the sensors of a node that is usable.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/time.hpp"
#include "host/core/ingest/range_gate.hpp"
#include "host/core/rig/host_rig.hpp"

namespace octoskin {

/// The worst that holds of a sensor.
enum class SensorSilence : std::uint8_t {
    none,         ///< or what there is to judge by does not suffice yet
    mostly_lost,  ///< of the readings that its node sent within some 3 s over half did not come
    /// No reading for a second and three periods, though its node says that it ranges, and sent more
    /// meanwhile than may be on the way.
    no_readings,
    unheard,  ///< is_unheard()
};

/// Neither a reading nor SENSOR_HEALTH came of it for SensorRecord::kUnheardAfter, nor was its node unusable
/// meanwhile: how it is, is not known. False while "now" is unknown.
[[nodiscard]] bool is_unheard(const SensorRecord& sensor, std::optional<HostTime> now);

/// More than this share of what is sent is mostly lost.
inline constexpr double kMostlyLost = 0.5;
/// `period`: as configured.
[[nodiscard]] SensorSilence silence_of(const SensorRecord& sensor, Nanoseconds period, HostTime now);

struct NodeSilence {
    struct OfSensor {
        std::size_t index = 0;
        SensorSilence what = SensorSilence::none;
    };
    /// It is the whole node's: of its other sensors it does not come either. What is in `sensors` beside it
    /// is worse.
    SensorSilence of_all = SensorSilence::none;
    /// Of these alone. One is in neither while it is not clear yet whether it is alone: of others that comes
    /// again what did not come of them.
    std::vector<OfSensor> sensors;
};
/// Of a node of the rig that is usable at `now`. O(sensors squared) where some are silent.
[[nodiscard]] NodeSilence silence_of(const RangeGate& ranges, const HostNode& node, HostTime now);

}  // namespace octoskin
