// Returned by everything that was given an I2C bus: is the bus still needed?
#pragma once

#include <cstdint>

namespace octoskin::node {

enum class BusUse : std::uint8_t {
    keeps,     ///< a transfer is in flight, or the next one follows at once
    releases,  ///< nothing to do before its next due time
};

}  // namespace octoskin::node
