// Limits of what the sensor of any rig can measure. They are checked for data from foreign files; without
// them a beam could be as large as the octree.
#pragma once

#include <cmath>
#include <numbers>

#include "host/core/beams/beam.hpp"

namespace octoskin {

inline constexpr double kRangeMax_m = 8.0;         ///< the rig file's largest range_limits.max_m
inline constexpr double kRangeSigmaMax_m = 1.0;    ///< the rig file's largest range_limits.sigma_max_m
inline constexpr double kClearLimitMax_m = 100.0;  ///< the mapping's largest no_return_clear_m
inline constexpr double kConeHalfAngleMax_rad = std::numbers::pi / 4.0;  ///< the rig file's largest

/// Checks a range and its sigma. False for a NaN.
[[nodiscard]] inline bool can_be_a_range(double range_m, double sigma_m) noexcept {
    return range_m >= 0.0 && range_m <= kRangeMax_m && sigma_m >= 0.0 && sigma_m <= kRangeSigmaMax_m;
}

/// Whether the values of a beam are within the limits. Its position and direction must be valid. O(1).
[[nodiscard]] inline bool is_within_limits(const Beam& beam) noexcept {
    constexpr double kNotTurned = 1e-6;
    const bool is_range = !beam.range_m || can_be_a_range(*beam.range_m, beam.sigma_m);
    const bool is_optics = beam.optics.half_angle_rad >= 0.0 &&
                           beam.optics.half_angle_rad <= kConeHalfAngleMax_rad &&
                           beam.optics.sigma_rad >= 0.0 && beam.optics.sigma_rad <= std::numbers::pi &&
                           (!beam.optics.is_cone() || beam.optics.sigma_rad > 0.0);
    const Eigen::Matrix3d turned_back = beam.R_map_sensor.transpose() * beam.R_map_sensor;
    return is_range && is_optics && beam.clear_limit_m >= 0.0 && beam.clear_limit_m <= kClearLimitMax_m &&
           (turned_back - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() <= kNotTurned;
}

}  // namespace octoskin
