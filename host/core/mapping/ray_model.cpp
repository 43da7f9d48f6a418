#include "host/core/mapping/ray_model.hpp"

#include <algorithm>
#include <span>

#include "host/core/voxels/ray_updates.hpp"

namespace octoskin {

RayModel::RayModel(const MappingConfig& config)
    : model_(config.model), no_return_clear_m_(config.no_return_clear_m), lattice_(config.map.resolution_m) {}

Result<const Evidence*, BeamRejection> RayModel::find(const Beam& beam) & {
    if (const auto fault = fault_of(beam)) return unexpected(*fault);
    const double length_m = beam.range_m.value_or(std::min(no_return_clear_m_, beam.clear_limit_m));
    if (!beam.range_m && length_m == 0.0) {
        evidence_.clear();
        return &evidence_;
    }
    const Eigen::Vector3f origin = beam.p_map_sensor.cast<float>();
    const Eigen::Vector3f end = (beam.p_map_sensor + length_m * beam.direction_map).cast<float>();
    const auto ray = plan_ray(lattice_, origin, end);
    if (!ray) return unexpected(BeamRejection::outside_map);
    const std::size_t passed = list_ray_updates(*ray, model_.miss_log_odds, updates_).size();
    const float hit = beam.range_m ? model_.proximity.log_odds(*beam.range_m) : 0.0F;
    updates_[passed] = {ray->last, hit};
    evidence_.take_in_order(std::span(updates_).first(passed + (hit != 0.0F ? 1 : 0)));
    return &evidence_;
}

}  // namespace octoskin
