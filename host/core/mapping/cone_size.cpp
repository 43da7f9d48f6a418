#include "host/core/mapping/cone_size.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace octoskin {
namespace {

/// In voxels, with a margin of one on each side, because a voxel counts if its centre is inside.
double cube_of(double radius_voxels) {
    const double edge = 2.0 * radius_voxels + 2.0;
    return edge * edge * edge;
}

/// Upper bound of the passed voxels: a truncated cone, one voxel larger on every side.
double passed_at_most(double length_voxels, double tan_core, double margin_voxels) {
    const double near = margin_voxels + 1.0;
    const double far = near + length_voxels * tan_core;
    return std::numbers::pi / 3.0 * (length_voxels + 2.0) * (near * near + near * far + far * far);
}

/// Upper bound of the box searched for a cap: the box of a ball about the middle of the cap's rim.
double cap_box_at_most(double furthest_voxels, double half_voxels, double angle_rad) {
    return cube_of(furthest_voxels * std::sin(angle_rad) + 2.0 * half_voxels);
}

}  // namespace

double cone_length_m(const Beam& beam, const MappingConfig& config) noexcept {
    return beam.range_m.value_or(std::min(config.no_return_clear_m, beam.clear_limit_m));
}

double cap_half_m(const Beam& beam, const MappingConfig& config) noexcept {
    const ConeModel& model = config.cone_of(beam.optics);
    return model.cap_half_thickness_m + model.cap_sigmas * beam.sigma_m;
}

double core_angle_rad(const BeamOptics& optics, const MappingConfig& config) noexcept {
    // Slices of wider cones are not ellipses (ConeFinder).
    constexpr double kCoreMax_rad = 0.6;
    const double weight_min = config.cone_of(optics).core_weight_min;
    return std::min(
        {optics.half_angle_rad, optics.sigma_rad * std::sqrt(-2.0 * std::log(weight_min)), kCoreMax_rad});
}

double cone_voxels_at_most(const Beam& beam, const MappingConfig& config) noexcept {
    const ConeModel& model = config.cone_of(beam.optics);
    const double per_m = 1.0 / config.map.resolution_m;
    const double length_m = cone_length_m(beam, config);
    const double passed = passed_at_most(length_m * per_m, std::tan(core_angle_rad(beam.optics, config)),
                                         model.core_margin_voxels);
    if (!beam.range_m || length_m > model.hit_range_max_m) return passed;
    const double half_m = cap_half_m(beam, config);
    const double angle_rad = model.cap_angle_share * beam.optics.half_angle_rad;
    return passed + cap_box_at_most((length_m + half_m) * per_m, half_m * per_m, angle_rad);
}

bool is_cone_too_large(const Beam& beam, const MappingConfig& config) noexcept {
    // A cube that extends this many voxels from its middle to each side has fewer voxels than
    // `kConeVoxelsMax`.
    constexpr double kReachAlways_voxels = 126.0;
    const double reach_m = cone_length_m(beam, config) + (beam.range_m ? cap_half_m(beam, config) : 0.0);
    return reach_m > kReachAlways_voxels * config.map.resolution_m &&
           cone_voxels_at_most(beam, config) > kConeVoxelsMax;
}

}  // namespace octoskin
