// The complete state on which later maps depend, given the same joint samples, readings and images.
#pragma once

#include <vector>

#include "host/core/mapping/camera_memory.hpp"
#include "host/core/mapping/fused_map.hpp"
#include "host/core/mapping/sensor_history.hpp"

namespace octoskin {

/// State at one moment. The map has log-odds, counts and times; its counters do not affect later maps.
/// Sensors that contradict the camera are not part of the state: they affect which readings go into the map,
/// not the map's response.
struct MapState {
    FusedMap map;
    SensorHistories histories;
    std::vector<CameraMemory> cameras = {};  ///< of those with an image so far, if the mapping needs it
};

}  // namespace octoskin
