// The kind of sensor that measured a voxel.
#pragma once

#include <cstdint>

namespace octoskin {

/// Ordered by strength: the evidence of a later kind is stronger.
enum class SensorKind : std::uint8_t {
    none,   ///< no sensor: the client of a query knows that the robot occupies the voxel
    range,  ///< a range sensor
    camera,
};

}  // namespace octoskin
