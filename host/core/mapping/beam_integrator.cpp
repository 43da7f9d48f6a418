#include "host/core/mapping/beam_integrator.hpp"

#include <algorithm>

#include "host/core/voxels/ray_keys.hpp"

namespace octoskin {

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
    std::vector<VoxelKey> passed;
    list_ray_keys(*ray, passed);
    const float hit = beam.range_m ? model_.proximity.log_odds(*beam.range_m) : 0.0F;
    updates.resize(passed.size() + (hit != 0.0F ? 1 : 0), {ray->last, hit});
    for (std::size_t i = 0; i < passed.size(); ++i) updates[i] = {passed[i], model_.miss_log_odds};
    return updates;
}

}  // namespace octoskin
