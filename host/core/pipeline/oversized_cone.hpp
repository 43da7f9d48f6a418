// Whether a rig's sensors see more of a mapping's voxels than one reading may speak of.
#pragma once

#include <cstddef>
#include <optional>

#include "host/core/mapping/mapping_config.hpp"
#include "host/core/rig/host_rig.hpp"

namespace octoskin {

struct OversizedCone {
    std::size_t node = 0;  ///< of `HostRig::nodes`
    std::size_t sensor = 0;
    BeamOptics optics;
    bool has_range = false;         ///< or it is one without return
    double length_m = 0.0;          ///< of its longest reading that is accepted
    double voxels = 0.0;            ///< that such a reading may have
    double resolution_min_m = 0.0;  ///< with voxels of this edge it may be mapped; two digits
};

/// The largest of those that are too large (`is_cone_too_large`); empty if there is none. O(zones).
[[nodiscard]] std::optional<OversizedCone> find_oversized_cone(const HostRig& rig,
                                                               const MappingConfig& mapping);

}  // namespace octoskin
