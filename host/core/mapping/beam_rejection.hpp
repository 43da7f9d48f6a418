// Checks that a beam can be mapped.
#pragma once

#include <cstdint>
#include <optional>

#include "host/core/beams/beam.hpp"

namespace octoskin {

/// Why a beam was refused.
enum class BeamRejection : std::uint8_t {
    origin_not_finite,
    direction_not_unit,  ///< not finite, or its length differs from 1 by more than 1e-6
    range_not_valid,     ///< not finite, or negative
    limit_not_valid,     ///< the clearing limit is not finite, or negative
    outside_map,         ///< origin or endpoint lies outside the octree
    cone_too_large,      ///< its cone may have more voxels than `kConeVoxelsMax`
};

/// Checks the beam's values only, not `outside_map` and `cone_too_large`. Empty: no fault.
[[nodiscard]] std::optional<BeamRejection> fault_of(const Beam& beam);

}  // namespace octoskin
