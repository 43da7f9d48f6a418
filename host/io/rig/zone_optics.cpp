#include "host/io/rig/zone_optics.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hw/rigfile/zone.hpp"

namespace octoskin {

BeamOptics beam_optics(const rig::Sensor& sensor, const Roi& zone) {
    constexpr double kRadPerDeg = std::numbers::pi / 180.0;
    if (!sensor.cone) return {};
    const double half_angle = sensor.cone->half_angle_deg * kRadPerDeg;
    const double sigma = sensor.cone->sigma_deg * kRadPerDeg;
    constexpr unsigned kArraySide = 16;
    if (zone.width == kArraySide && zone.height == kArraySide) return {half_angle, sigma, false};
    const double blur = sensor.cone->blur_deg * kRadPerDeg;
    const double width = zone.width * rig::kSpadPitch_rad;
    const double height = zone.height * rig::kSpadPitch_rad;
    constexpr double kBlurEnd = 1.5;
    const double variance = (width * width + height * height) / 24.0 +
                            blur * blur;  // the variance of a uniform distribution is w^2 / 12
    return {std::min(half_angle, 0.5 * std::hypot(width, height) + kBlurEnd * blur),
            1.0 / std::sqrt(1.0 / variance + 1.0 / (sigma * sigma)),
            2U * zone.width * zone.height <= kArraySide * kArraySide};
}

}  // namespace octoskin
