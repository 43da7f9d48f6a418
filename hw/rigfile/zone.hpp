// Regions of interest on the VL53L1X's 16 x 16 SPAD array.
#pragma once

#include <Eigen/Core>
#include <numbers>

#include "common/config/node_config.hpp"

namespace octoskin::rig {

/// True if the zone lies on the array; elsewhere the device reports status 13. Source: UM2555 rev 2, whose
/// numbering of SPADs and rule for even sides (centre to the right of, or above, the true one) are used.
[[nodiscard]] bool fits_on_array(const Roi& roi) noexcept;

/// Unit vector along the middle of the zone's beam, sensor frame; +z exactly for the whole array. The frame:
/// z out of the sensor; facing it with UM2555's SPAD table upright, x to the right and y up. The lens
/// inverts, so a zone at the table's lower right looks to the upper left. 27 degrees across the array's
/// diagonal (datasheet DS12385 rev 7).
[[nodiscard]] Eigen::Vector3d zone_direction(const Roi& roi) noexcept;

/// Angle across one SPAD: 27 degrees over the diagonal of 16.
inline constexpr double kSpadPitch_rad = 27.0 / (16 * std::numbers::sqrt2) * std::numbers::pi / 180.0;
/// Angle from the array's middle to its side.
inline constexpr double kArrayHalfWidth_rad = 8 * kSpadPitch_rad;

/// Angles to the sensor's axis, min below max.
struct ZoneSpan {
    double min_rad = 0.0;
    double max_rad = 0.0;
};
/// The angles towards +x and towards +y between which a zone looks with a sharp lens, in the frame of
/// zone_direction(). A ray's angle towards x is atan2(x, z).
[[nodiscard]] ZoneSpan zone_span_x(const Roi& roi) noexcept;
[[nodiscard]] ZoneSpan zone_span_y(const Roi& roi) noexcept;

}  // namespace octoskin::rig
