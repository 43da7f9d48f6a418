#include "host/core/mapping/beam_integrator.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "host/core/voxels/ray_walk.hpp"

namespace octoskin {
namespace {

bool is_valid_distance(double distance_m) {
    return std::isfinite(distance_m) && distance_m >= 0.0;
}

std::optional<BeamRejection> fault_of(const Beam& beam) {
    if (!beam.p_map_sensor.allFinite()) return BeamRejection::origin_not_finite;
    // Written so that a NaN fails it.
    if (!(std::fabs(beam.direction_map.norm() - 1.0) <= 1e-6)) return BeamRejection::direction_not_unit;
    if (beam.range_m && !is_valid_distance(*beam.range_m)) return BeamRejection::range_not_valid;
    if (!beam.range_m && !is_valid_distance(beam.clear_limit_m)) return BeamRejection::limit_not_valid;
    return std::nullopt;
}

}  // namespace

BeamIntegrator::BeamIntegrator(const MappingConfig& config)
    : model_(config.model), no_return_clear_m_(config.no_return_clear_m), lattice_(config.map.resolution_m) {}

Result<std::vector<VoxelUpdate>, BeamRejection> BeamIntegrator::integrate(const Beam& beam) const {
    if (const auto fault = fault_of(beam)) return unexpected(*fault);
    const double length_m = beam.range_m.value_or(std::min(no_return_clear_m_, beam.clear_limit_m));
    std::vector<VoxelUpdate> updates;
    if (!beam.range_m && length_m == 0.0) return updates;

    const Eigen::Vector3f origin = beam.p_map_sensor.cast<float>();
    const Eigen::Vector3f end = (beam.p_map_sensor + length_m * beam.direction_map).cast<float>();
    const auto ray = plan_ray(lattice_, origin, end);
    if (!ray) return unexpected(BeamRejection::outside_map);
    updates.reserve(static_cast<std::size_t>(ray->steps_max) + 2);
    walk_ray_keys(*ray, [&](VoxelKey key) { updates.push_back({key, model_.miss_log_odds}); });
    if (beam.range_m) {
        const float hit = model_.proximity.log_odds(*beam.range_m);
        if (hit != 0.0F) updates.push_back({ray->last, hit});
    }
    return updates;
}

}  // namespace octoskin
