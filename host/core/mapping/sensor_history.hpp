// What each range sensor read most recently, as far as later maps follow from it.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <vector>

#include "host/core/beams/beam.hpp"
#include "host/core/rig/sensor_id.hpp"

namespace octoskin {

/// Of one zone. ConfirmedRanges keeps the first two for zones that see a cone, SeenThrough the last for all.
struct ZoneHistory {
    struct Reading {
        Beam beam;
        std::uint64_t number = 0;  ///< of the sensor's, from 1
        bool is_confirmed = false;
    };
    struct Passage {
        Beam beam;
        double frees_m = 0.0;
    };
    std::vector<Reading> newest;    ///< the newest last
    std::optional<Beam> confirmed;  ///< has a range
    std::deque<Passage> passages;   ///< the newest last; none if there was no memory
};

struct SensorHistory {
    std::uint64_t readings = 0;  ///< that ConfirmedRanges took
    std::map<std::uint8_t, ZoneHistory> zones;
};

/// 2 kB a zone.
using SensorHistories = SensorTable<SensorHistory>;

}  // namespace octoskin
