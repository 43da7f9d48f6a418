#include "host/core/mapping/free_evidence.hpp"

#include <algorithm>
#include <cmath>

namespace octoskin {
namespace {

/// Rounding keeps three misses of 0.4 from being less than three images.
double measurements(float amount, float unit) {
    if (!(amount > 0.0F) || !(unit > 0.0F)) return 0.0;
    constexpr double kSteps = 100.0;
    return std::round(kSteps * static_cast<double>(amount) / static_cast<double>(unit)) / kSteps;
}

}  // namespace

MissUnits miss_units(const MappingConfig& config) noexcept {
    return {.log_odds = -config.model.miss_log_odds,
            .misses = std::max(config.cone.miss_mass, config.zone.miss_mass)};
}

FreeEvidence free_evidence(const VoxelState& voxel, const MissUnits& units) noexcept {
    // A prior of NaN is no evidence: NaN is not above 0.
    return {.images = measurements(-voxel.prior, units.log_odds),
            .beams = measurements(voxel.misses - voxel.hits, units.misses)};
}

}  // namespace octoskin
