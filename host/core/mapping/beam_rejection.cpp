#include "host/core/mapping/beam_rejection.hpp"

#include <cmath>

namespace octoskin {
namespace {

bool is_valid_distance(double distance_m) {
    return std::isfinite(distance_m) && distance_m >= 0.0;
}

}  // namespace

std::optional<BeamRejection> fault_of(const Beam& beam) {
    if (!beam.p_map_sensor.allFinite()) return BeamRejection::origin_not_finite;
    // Written so that a NaN fails it.
    if (!(std::fabs(beam.direction_map.norm() - 1.0) <= 1e-6)) return BeamRejection::direction_not_unit;
    if (beam.range_m && !is_valid_distance(*beam.range_m)) return BeamRejection::range_not_valid;
    if (!beam.range_m && !is_valid_distance(beam.clear_limit_m)) return BeamRejection::limit_not_valid;
    return std::nullopt;
}

}  // namespace octoskin
