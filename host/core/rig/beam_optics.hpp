// The field of view of a range sensor's zone.
#pragma once

namespace octoskin {

/// A cone whose signal decreases from the axis as a Gaussian of the angle. With the default values it is one
/// ideal ray. Each narrower zone of a sensor has its own BeamOptics about its own axis.
struct BeamOptics {
    double half_angle_rad = 0.0;  ///< from the axis to the edge of the field of view; 0: an ideal ray
    double sigma_rad = 0.0;       ///< of the Gaussian
    /// A zone of at most half of the sensor's array; a map has separate parameters for such zones.
    bool is_zone = false;

    [[nodiscard]] constexpr bool is_cone() const noexcept { return half_angle_rad > 0.0; }
    friend constexpr bool operator==(const BeamOptics&, const BeamOptics&) = default;
};

}  // namespace octoskin
