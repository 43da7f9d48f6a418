// All that later maps follow from, given the same joint samples, readings and images.
#pragma once

#include "host/core/mapping/fused_map.hpp"
#include "host/core/mapping/sensor_history.hpp"

namespace octoskin {

/// As of one moment. The map has log-odds, counts and times; its counters are of no consequence for later
/// maps. What sensors contradict the camera is no part of it: it decides what goes in, not what becomes of
/// that.
struct MapState {
    FusedMap map;
    SensorHistories histories;
};

}  // namespace octoskin
