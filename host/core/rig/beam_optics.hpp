// What a range sensor's zone sees about its axis.
#pragma once

namespace octoskin {

/// A cone whose signal falls off from the axis as a Gaussian of the angle; or, as it is without figures, one
/// ideal ray. A narrower zone of the same sensor is another one of these, about an axis of its own.
struct BeamOptics {
    double half_angle_rad = 0.0;  ///< from the axis to where nothing is seen any more; 0: an ideal ray
    double sigma_rad = 0.0;       ///< of the Gaussian
    /// A zone of at most half of the sensor's array: a map has other parameters for those.
    bool is_zone = false;

    [[nodiscard]] constexpr bool is_cone() const noexcept { return half_angle_rad > 0.0; }
    friend constexpr bool operator==(const BeamOptics&, const BeamOptics&) = default;
};

}  // namespace octoskin
