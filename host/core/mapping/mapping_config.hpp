// All parameters that decide how measurements become voxels. Four named configurations are built in; a file
// may override any value (host/io/mapping).
#pragma once

#include <cstdint>

#include "host/core/depth/depth_denoiser.hpp"
#include "host/core/depth/depth_filter.hpp"
#include "host/core/mapping/cone_model.hpp"
#include "host/core/mapping/map_config.hpp"
#include "host/core/mapping/stationary_model.hpp"
#include "host/core/mapping/update_model.hpp"
#include "host/core/rig/beam_optics.hpp"

namespace octoskin {

enum class DepthUpdate : std::uint8_t {
    paper,   ///< sets: one term per frame and voxel, hit wins over passed
    robust,  ///< each voxel's term is the mean of its rays' terms; for a filtered image
    /// For a filtered image. A voxel's rays are those that are in it at its centre's depth. If no ray ends in
    /// the voxel and one of its rays continues, the voxel gets a miss. If rays end in it, the voxel gets the
    /// mean of hits (rays that end before the centre) and misses (rays that continue), or nothing if the mean
    /// is not above 0.
    fast,
    /// For a camera's own images: they are denoised over time and over the pixels of a surface
    /// (DepthDenoiser). Then any ray that ends in a voxel is a hit, as with `paper`. An end that a newer
    /// estimate replaces is retracted.
    denoised,
};

enum class RangeUpdate : std::uint8_t {
    ray,   ///< the paper's: a miss for each voxel along the axis, a hit at its end
    cone,  ///< a sensor with a cone counts hits and misses; others as with `ray`
};

/// For a zone of 6 x 6 SPADs of a VL53L1X, in a 3 x 3 grid: the range of a narrow beam locates its surface
/// better and marks from further away.
[[nodiscard]] ConeModel zone_model();

struct MappingConfig {
    MapConfig map;
    UpdateModel model;
    RangeUpdate range_update = RangeUpdate::ray;
    /// Of a ray: its surface may be so many sigmas before the measured range. There a miss takes from what is
    /// occupied and frees nothing. 0: the ray passes all up to its end, as in the paper.
    double ray_end_sigmas = 0.0;
    ConeModel cone = {};            ///< for sensors that see all of their cone at a time, or more than half
    ConeModel zone = zone_model();  ///< for a zone of at most half of its array's SPADs
    StationaryModel standing = {};  ///< for both, while they are stationary
    DepthUpdate depth_update = DepthUpdate::robust;
    DepthFilterConfig depth_filter;
    DepthDenoiserConfig depth_denoiser;  ///< with `denoised` in place of the filter
    /// With `denoised`, of an image of a moving camera, in place of `UpdateModel::miss_log_odds`: its noise
    /// is not averaged over time, and a beam that passes a thin object by an error must not outweigh the
    /// hits.
    float moving_miss_log_odds = -0.2F;
    /// A depth pixel with a larger range clears space up to here and marks nothing; 0: no maximum.
    double depth_range_max_m = 0.0;
    bool removes_robot_from_depth = true;
    bool removes_robot_from_ranges = true;
    /// Each range is compared with the camera's image. A sensor, or the camera, that contradicts the others
    /// is reported (host/core/cross_check).
    bool reports_contradicting_sensors = true;
    /// The readings of a reported sensor are not put into the map. Requires `reports_contradicting_sensors`.
    bool refuses_contradicting_sensors = false;
    /// A beam without return clears space up to here, and never beyond its own limit; 0: it changes nothing.
    double no_return_clear_m = 0.0;
    /// Maximum number of voxels in the box around one image's rays (1 byte each with `paper`, 8 with
    /// `robust`); an image with a larger box is refused.
    std::uint32_t depth_box_voxels_max = 1U << 26U;
    static constexpr double kUsualDepth_m = 2.5;
    /// True if the camera's images lose their noise before they become rays.
    [[nodiscard]] bool removes_camera_noise() const noexcept {
        return depth_update == DepthUpdate::denoised || depth_filter.is_enabled;
    }
    /// The camera's noise, metres; of a noise law at a depth of 2.5 m.
    [[nodiscard]] double camera_sigma_m() const noexcept {
        return depth_update == DepthUpdate::denoised ? depth_denoiser.noise.sigma_m(kUsualDepth_m)
                                                     : depth_filter.sigma_m;
    }
    /// The parameters for counting a range of a beam with these optics, which are a cone.
    [[nodiscard]] const ConeModel& cone_of(const BeamOptics& optics) const noexcept {
        return optics.is_zone ? zone : cone;
    }
    friend bool operator==(const MappingConfig&, const MappingConfig&) = default;
};

/// The paper's equations unchanged: no filter, one term per voxel and frame.
[[nodiscard]] MappingConfig paper_mapping();
/// The default: depth denoised over time, and any ray that ends in a voxel is a hit, as with `paper`.
[[nodiscard]] MappingConfig denoised_mapping();
/// Depth filtered, each voxel's term is the mean of its rays' terms. The former default, and the reference
/// for `fast`.
[[nodiscard]] MappingConfig robust_mapping();
/// Depth filtered, each voxel evaluated by the rays near its centre.
[[nodiscard]] MappingConfig fast_mapping();
/// The one of these with this update.
[[nodiscard]] MappingConfig mapping_with(DepthUpdate update);

}  // namespace octoskin
