// What measured a voxel.
#pragma once

#include <cstdint>

namespace octoskin {

/// The later one's evidence is the stronger.
enum class SensorKind : std::uint8_t {
    none,   ///< no sensor: the client of a query knows that the robot itself is there
    range,  ///< a range sensor
    camera,
};

}  // namespace octoskin
