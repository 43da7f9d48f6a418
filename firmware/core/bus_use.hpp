// The answer of everything that was given an I2C bus: does it need the bus further?
#pragma once

#include <cstdint>

namespace octoskin::node {

enum class BusUse : std::uint8_t {
    keeps,     ///< a transfer is in flight, or the next one follows at once
    releases,  ///< nothing to do before its own due time
};

}  // namespace octoskin::node
