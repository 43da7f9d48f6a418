// The noise of a depth camera as a function of depth.
#pragma once

#include <cmath>

namespace octoskin {

/// Standard deviation of one pixel's depth from image to image: `constant_m` + `quadratic_per_m` * (depth -
/// `from_m`)^2, metres. A structured-light camera's grows with the square of the depth (Khoshelham and
/// Elberink 2012).
struct DepthNoiseLaw {
    double constant_m = 0.03;
    double quadratic_per_m = 0.0;
    double from_m = 0.4;
    /// What stays the same from image to image and from pixel to pixel nearby, so that no mean removes it:
    /// this times the square of the depth, metres. 0.0015 for a Kinect.
    double bias_per_m = 0.0;

    [[nodiscard]] double sigma_m(double depth_m) const noexcept {
        const double beyond_m = depth_m - from_m;
        return constant_m + quadratic_per_m * beyond_m * beyond_m;
    }
    friend bool operator==(const DepthNoiseLaw&, const DepthNoiseLaw&) = default;
};

}  // namespace octoskin
