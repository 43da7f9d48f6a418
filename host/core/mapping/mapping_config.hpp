// Everything that decides how measurements become voxels. Three named configurations ship; a file may
// override any value (host/io/mapping).
#pragma once

#include <cstdint>

#include "host/core/depth/depth_filter.hpp"
#include "host/core/mapping/cone_model.hpp"
#include "host/core/mapping/map_config.hpp"
#include "host/core/mapping/stationary_model.hpp"
#include "host/core/mapping/update_model.hpp"
#include "host/core/rig/beam_optics.hpp"

namespace octoskin {

enum class DepthUpdate : std::uint8_t {
    paper,   ///< set-wise: per frame and voxel one term, hit wins over traversed
    robust,  ///< each voxel's term is the mean of its beams' terms; meant for a filtered image
    /// Meant for a filtered image, and voxel by voxel: its rays are those that are in it at its centre's
    /// depth. If no ray ends in it, one of them that goes on makes a miss. If any does, it gets the mean of
    /// hits, for its rays that end before the centre, and misses, for those that go on, or nothing if that is
    /// no more than 0.
    fast,
};

enum class RangeUpdate : std::uint8_t {
    ray,   ///< the paper's: a miss for each voxel along the axis, a hit at its end
    cone,  ///< a sensor whose optics are a cone counts hits and misses; others are as with `ray`
};

/// For a zone of 6 x 6 SPADs of a VL53L1X, one of 3 x 3: a narrow beam's range tells more of where its
/// surface is, and marks from further away.
[[nodiscard]] ConeModel zone_model();

struct MappingConfig {
    MapConfig map;
    UpdateModel model;
    RangeUpdate range_update = RangeUpdate::ray;
    ConeModel cone = {};            ///< of sensors that see all of their cone at a time, or more than half
    ConeModel zone = zone_model();  ///< of a zone of at most half of its array's SPADs
    StationaryModel standing = {};  ///< of both, while they stand still
    DepthUpdate depth_update = DepthUpdate::robust;
    DepthFilterConfig depth_filter;
    /// A depth pixel whose range is larger clears space up to here and marks nothing; 0: no maximum.
    double depth_range_max_m = 0.0;
    bool removes_robot_from_depth = true;
    bool removes_robot_from_ranges = true;
    /// Each range is compared with the camera's image, and a sensor that contradicts it is named, or the
    /// camera (host/core/witness).
    bool reports_contradicting_sensors = true;
    /// And the readings of one that is named stay out of the map. It takes the reports.
    bool refuses_contradicting_sensors = false;
    /// A beam without return clears space up to here, and never beyond its own limit; 0 leaves the map alone.
    double no_return_clear_m = 0.0;
    /// The box around one image's rays may hold this many voxels (1 byte each with `paper`, 8 with
    /// `robust`); a larger one is refused.
    std::uint32_t depth_box_voxels_max = 1U << 26U;
    /// How a range of a beam with these optics, which are a cone, is counted.
    [[nodiscard]] const ConeModel& cone_of(const BeamOptics& optics) const noexcept {
        return optics.is_zone ? zone : cone;
    }
    friend bool operator==(const MappingConfig&, const MappingConfig&) = default;
};

/// The paper's equations as they stand: no filter, one term per voxel and frame.
[[nodiscard]] MappingConfig paper_mapping();
/// Depth filtered, each voxel's term the mean of its beams' terms: the default before `fast`, and its
/// reference.
[[nodiscard]] MappingConfig robust_mapping();
/// The default: depth filtered, each voxel asked what the rays about its centre do.
[[nodiscard]] MappingConfig fast_mapping();

}  // namespace octoskin
