// Parameters that turn a cone's range into counts of hits and misses, and weigh counts against a camera's
// log-odds. The values were chosen for a VL53L1X that sees its whole cone; those for zones: zone_model() in
// mapping_config.hpp. See docs/concepts/sensor-models.md.
#pragma once

namespace octoskin {

/// Which voxels a range is about, and the weight of its hits and misses.
struct ConeModel {
    /// Longer ranges free space and mark nothing occupied: their cap is too large to locate the surface.
    double hit_range_max_m = 0.7;
    /// A voxel is in the cap if the range of its centre differs from the measured range by at most this plus
    /// `cap_sigmas` sigmas of the range.
    double cap_half_thickness_m = 0.045;
    double cap_sigmas = 1.0;
    /// Angle of the cap off the axis, as a fraction of the optics' half angle.
    double cap_angle_share = 1.0;
    /// Space is freed where the beam's weight is at least this fraction of the weight on its axis,
    double core_weight_min = 0.5;
    /// and this far beside, in voxel edges.
    double core_margin_voxels = 0.5;
    float hit_mass = 1.0F;    ///< hits that a range adds to all voxels of its cap together
    float miss_mass = 0.37F;  ///< misses that a range adds to each voxel that it frees
    friend constexpr bool operator==(const ConeModel&, const ConeModel&) = default;
};

/// The odds of a voxel are (a + hits) / (b + misses); a and b follow from the prior without counts.
struct CountModel {
    float prior_hits = 0.37F;  ///< a of an unknown voxel
    float prior_misses = 0.75F;
    float occupied_hits = 25.0F;  ///< added to a at the log-odds' upper clamp; in proportion below
    float free_misses = 1.0F;     ///< added to b at the lower clamp
    /// A voxel with counts and enough hits is occupied from this probability on.
    float occupied_probability = 0.42F;
    /// A voxel with fewer hits is not occupied, unless its log-odds without counts are. A larger value
    /// increases precision and decreases recall.
    float hits_min = 0.8F;
    /// A voxel that only range sensors with a cone have measured is free if it has more misses than this;
    /// otherwise unknown.
    float misses_min = 1.65F;
    float counts_max = 10.0F;  ///< limit of hits plus misses of a voxel; beyond it, both are scaled down
    /// Fraction of a voxel's hits that an image removes if all its rays pass the voxel. Without it, an object
    /// that has left would remain where only the camera looks.
    float image_clears = 0.4F;
    /// Fraction of a voxel's misses that an image removes if it marks the voxel occupied, so that a new
    /// object appears soon.
    float image_marks = 0.4F;
    /// Log-odds that a range's miss removes from a voxel's prior while the prior is above 0, once the voxel
    /// has `range_clears_from` misses: for an object that the camera saw and that left while the camera did
    /// not look.
    float range_clears = 0.25F;
    float range_clears_from = 3.0F;
    friend constexpr bool operator==(const CountModel&, const CountModel&) = default;
};

}  // namespace octoskin
