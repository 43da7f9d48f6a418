// When ranges of a stationary sensor immediately mark a new object, and free the space of one that has left.
#pragma once

#include <cstdint>

namespace octoskin {

/// The hits of a cone's range are shared by its whole cap, and readings from many places locate the surface
/// within the cap. Readings from one place cannot, and shared hits mark a voxel only after many readings.
/// Without this model, a new object in front of a stationary sensor would appear on the map too late.
struct StationaryModel {
    /// Number of readings among a sensor's last `window()` that must agree to be confirmed at once; 0: never.
    std::uint32_t readings = 0;
    float hits = 2.0F;          ///< minimum hits that a confirmation leaves in a voxel, without misses
    double angle_share = 0.25;  ///< angle off the axis, as a fraction of the optics' half angle

    /// Space that readings of one zone agree to see through for this time is freed at once; 0: never.
    double clears_after_s = 0.0;

    /// Some readings may be wrong or missing; a new object is then still on the map after 0.2 s at 30
    /// readings a second.
    [[nodiscard]] constexpr std::uint32_t window() const noexcept { return readings + 3; }
    friend constexpr bool operator==(const StationaryModel&, const StationaryModel&) = default;
};

}  // namespace octoskin
