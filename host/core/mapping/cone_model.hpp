// How a cone's range becomes counts of hits and misses, and what counts beside a camera's log-odds are worth.
// The figures were chosen for a VL53L1X that sees its whole cone; those for zones: zone_model() in
// mapping_config.hpp. See docs/method.md.
#pragma once

namespace octoskin {

/// Of what a range speaks, and how loudly.
struct ConeModel {
    /// Longer ranges free space and mark nothing: their cap is too large to say where the surface is.
    double hit_range_max_m = 0.7;
    /// A voxel is in the cap if its centre's range is within this, and so many sigmas of the range, of the
    /// measured one.
    double cap_half_thickness_m = 0.045;
    double cap_sigmas = 1.0;
    /// How far off the axis the cap reaches, of the way to where nothing is seen any more.
    double cap_angle_share = 1.0;
    /// Space is freed where the beam weighs at least this part of what it weighs on its axis,
    double core_weight_min = 0.5;
    /// and this far beside, in edges of a voxel.
    double core_margin_voxels = 0.5;
    float hit_mass = 1.0F;    ///< what a range adds to the hits of all voxels of its cap together
    float miss_mass = 0.37F;  ///< and to the misses of each voxel that it frees
    friend constexpr bool operator==(const ConeModel&, const ConeModel&) = default;
};

/// The odds of a voxel are (a + hits) / (b + misses), where a and b are what is known without counts.
struct CountModel {
    float prior_hits = 0.37F;  ///< of a before anything is known
    float prior_misses = 0.75F;
    float occupied_hits = 25.0F;  ///< more of a, at the log-odds' upper clamp; in proportion below
    float free_misses = 1.0F;     ///< more of b, at the lower clamp
    /// The probability from which on a voxel with counts is occupied, if it has hits enough.
    float occupied_probability = 0.42F;
    /// A voxel with fewer hits is not occupied unless its log-odds say so without counts: the knob between
    /// precision (more) and recall (less).
    float hits_min = 0.8F;
    /// A voxel of which only range sensors that see a cone spoke is free if it has more misses; else unknown.
    float misses_min = 1.65F;
    float counts_max = 10.0F;  ///< hits and misses of a voxel together; beyond, both are scaled down
    /// What an image whose rays all pass a voxel takes of its hits: so that something that has left does not
    /// stay where only the camera looks.
    float image_clears = 0.4F;
    /// And what one that marks a voxel takes of its misses: what was free and is not shall not wait for them.
    float image_marks = 0.4F;
    /// What a range's miss takes of a voxel's other log-odds, as long as they are above 0, once the voxel has
    /// so many misses: what the camera was sure of and left while it did not look.
    float range_clears = 0.25F;
    float range_clears_from = 3.0F;
    friend constexpr bool operator==(const CountModel&, const CountModel&) = default;
};

}  // namespace octoskin
