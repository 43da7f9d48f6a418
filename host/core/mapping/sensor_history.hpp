// The newest readings of each range sensor, as far as later maps depend on them.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <vector>

#include "host/core/beams/beam.hpp"
#include "host/core/rig/sensor_id.hpp"

namespace octoskin {

/// History of one zone. ConfirmedRanges uses the first two members for zones with a cone, SeenThrough the
/// last for all.
struct ZoneHistory {
    struct Reading {
        Beam beam;
        std::uint64_t number = 0;  ///< number among the sensor's readings, from 1
        bool is_confirmed = false;
    };
    struct Passage {
        Beam beam;
        double frees_m = 0.0;
    };
    std::vector<Reading> newest;    ///< the newest last
    std::optional<Beam> confirmed;  ///< has a range
    std::deque<Passage> passages;   ///< the newest last; empty if there was no memory
};

struct SensorHistory {
    std::uint64_t readings = 0;  ///< number of readings that ConfirmedRanges took
    std::map<std::uint8_t, ZoneHistory> zones;
};

/// About 2 kB for each zone.
using SensorHistories = SensorTable<SensorHistory>;

}  // namespace octoskin
