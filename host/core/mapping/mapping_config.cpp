#include "host/core/mapping/mapping_config.hpp"

namespace octoskin {

ConeModel zone_model() {
    return {.hit_range_max_m = 2.0,
            .cap_half_thickness_m = 0.032,
            .cap_sigmas = 1.0,
            .cap_angle_share = 0.58,
            .core_weight_min = 0.475,
            .core_margin_voxels = 0.5,
            .hit_mass = 2.4F,
            .miss_mass = 1.2F};
}

MappingConfig paper_mapping() {
    MappingConfig config;
    config.depth_update = DepthUpdate::paper;
    config.depth_filter.is_enabled = false;
    return config;
}

MappingConfig robust_mapping() {
    MappingConfig config;
    config.depth_update = DepthUpdate::robust;
    config.range_update = RangeUpdate::cone;
    config.standing.readings = 4;
    config.standing.clears_after_s = 0.55;
    config.map.log_odds_passed_max = 1.5F;
    config.map.log_odds_hit_min = -0.4F;
    config.map.age = {.stale_after_s = 60, .unknown_after_s = 600};
    config.depth_filter.is_enabled = true;
    return config;
}

MappingConfig fast_mapping() {
    MappingConfig config = robust_mapping();
    config.depth_update = DepthUpdate::fast;
    return config;
}

MappingConfig denoised_mapping() {
    MappingConfig config = robust_mapping();
    config.depth_update = DepthUpdate::denoised;
    config.map.log_odds_hit_min = 0.0F;
    config.map.log_odds_passed_max = 2.5F;
    config.map.counts.misses_min = 3.0F;
    config.ray_end_sigmas = 2.0;
    config.depth_filter.is_enabled = false;
    return config;
}

MappingConfig mapping_with(DepthUpdate update) {
    switch (update) {
        case DepthUpdate::paper:
            return paper_mapping();
        case DepthUpdate::robust:
            return robust_mapping();
        case DepthUpdate::fast:
            return fast_mapping();
        case DepthUpdate::denoised:
            break;
    }
    return denoised_mapping();
}

}  // namespace octoskin
