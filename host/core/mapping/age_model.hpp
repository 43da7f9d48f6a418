// How long a map's evidence holds.
#pragma once

#include <cstdint>

namespace octoskin {

/// What becomes of a voxel that no sensor has confirmed for so long, whole seconds, up to 7200; 0: nothing
/// ever.
struct AgeModel {
    std::uint32_t stale_after_s = 0;    ///< it is stale: what is free is not to be relied on
    std::uint32_t unknown_after_s = 0;  ///< it is unknown, as if nothing had ever been measured there
    friend constexpr bool operator==(const AgeModel&, const AgeModel&) = default;
};

}  // namespace octoskin
