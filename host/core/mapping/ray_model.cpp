#include "host/core/mapping/ray_model.hpp"

#include <algorithm>
#include <span>

#include "host/core/voxels/ray_updates.hpp"

namespace octoskin {

RayModel::RayModel(const MappingConfig& config)
    : model_(config.model),
      no_return_clear_m_(config.no_return_clear_m),
      end_sigmas_(config.ray_end_sigmas),
      lattice_(config.map.resolution_m) {
    evidence_.weakened.miss = model_.miss_log_odds;
}

std::size_t RayModel::surely_passed(const Beam& beam, std::size_t passed) const {
    if (!beam.range_m || end_sigmas_ == 0.0) return passed;
    const double surely_m = *beam.range_m - end_sigmas_ * beam.sigma_m - 0.5 * lattice_.resolution_m();
    const auto is_sure = [&](const VoxelUpdate& update) {
        return (lattice_.centre_of(update.key) - beam.p_map_sensor).dot(beam.direction_map) <= surely_m;
    };
    while (passed > 0 && !is_sure(updates_[passed - 1])) --passed;
    return passed;
}

Result<const RayEvidence*, BeamRejection> RayModel::find(const Beam& beam) & {
    if (const auto fault = fault_of(beam)) return unexpected(*fault);
    const double length_m = beam.range_m.value_or(std::min(no_return_clear_m_, beam.clear_limit_m));
    evidence_.terms.clear();
    evidence_.weakened.clear();
    if (!beam.range_m && length_m == 0.0) return &evidence_;
    const Eigen::Vector3f origin = beam.p_map_sensor.cast<float>();
    const Eigen::Vector3f end = (beam.p_map_sensor + length_m * beam.direction_map).cast<float>();
    const auto ray = plan_ray(lattice_, origin, end);
    if (!ray) return unexpected(BeamRejection::outside_map);
    const std::size_t all = list_ray_updates(*ray, model_.miss_log_odds, updates_).size();
    const std::size_t passed = surely_passed(beam, all);
    for (const VoxelUpdate& update : std::span(updates_).subspan(passed, all - passed))
        put_in(evidence_.weakened.last(brick_of(update.key)).voxels, cell_of(update.key));
    const float hit = beam.range_m ? model_.proximity.log_odds(*beam.range_m) : 0.0F;
    updates_[passed] = {ray->last, hit};
    evidence_.terms.take_in_order(std::span(updates_).first(passed + (hit != 0.0F ? 1 : 0)));
    return &evidence_;
}

}  // namespace octoskin
