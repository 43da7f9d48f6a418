// When ranges of a sensor that does not move mark at once what has come before it, and free what has gone.
#pragma once

#include <cstdint>

namespace octoskin {

/// A range of a cone is shared by all of its cap, and readings from many places tell where in it the surface
/// is. From one place no reading does, and a share takes many readings to mark: so what came before a sensor
/// that stands still would not be on the map in time.
struct StationaryModel {
    /// So many readings that agree are confirmed at once, of a sensor's last `window()`; 0: none ever are.
    std::uint32_t readings = 0;
    float hits = 2.0F;          ///< what they leave a voxel at least, and no misses
    double angle_share = 0.25;  ///< how far off the axis, of the way to where nothing is seen any more

    /// What readings of one zone over so long agree to see through is free at once; 0: nothing ever is.
    double clears_after_s = 0.0;

    /// Some may be wrong or fail, and what has come is still on the map after 0.2 s at 30 readings a second.
    [[nodiscard]] constexpr std::uint32_t window() const noexcept { return readings + 3; }
    friend constexpr bool operator==(const StationaryModel&, const StationaryModel&) = default;
};

}  // namespace octoskin
