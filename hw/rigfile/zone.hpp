// Regions of interest on the VL53L1X's 16 x 16 SPAD array.
#pragma once

#include <Eigen/Core>

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

}  // namespace octoskin::rig
