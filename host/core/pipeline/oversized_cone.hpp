// Checks whether a reading of the rig's sensors may cover more voxels of a mapping than allowed.
#pragma once

#include <cstddef>
#include <optional>

#include "host/core/mapping/mapping_config.hpp"
#include "host/core/rig/host_rig.hpp"

namespace octoskin {

struct OversizedCone {
    std::size_t node = 0;  ///< index in `HostRig::nodes`
    std::size_t sensor = 0;
    BeamOptics optics;
    bool has_range = false;         ///< false: a reading without return
    double length_m = 0.0;          ///< of its longest reading that is accepted
    double voxels = 0.0;            ///< upper bound for such a reading
    double resolution_min_m = 0.0;  ///< smallest voxel edge with which it can be mapped; two digits
};

/// The largest cone that is too large (`is_cone_too_large`); empty if there is none. O(zones).
[[nodiscard]] std::optional<OversizedCone> find_oversized_cone(const HostRig& rig,
                                                               const MappingConfig& mapping);

}  // namespace octoskin
