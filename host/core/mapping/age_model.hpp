// How long a map's evidence stays valid.
#pragma once

#include <cstdint>

namespace octoskin {

/// State of a voxel that no sensor has confirmed for this time, in whole seconds, up to 7200. 0: never.
struct AgeModel {
    std::uint32_t stale_after_s = 0;    ///< it is stale: free space is not reliable
    std::uint32_t unknown_after_s = 0;  ///< it is unknown, as if nothing had ever been measured there
    friend constexpr bool operator==(const AgeModel&, const AgeModel&) = default;
};

}  // namespace octoskin
