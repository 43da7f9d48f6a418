// The evidence behind a free voxel, in measurements: how many passed it more than ended in it.
#pragma once

#include "host/core/mapping/mapping_config.hpp"
#include "host/core/mapping/voxel_rules.hpp"

namespace octoskin {

/// What one measurement adds to a voxel that it passes. With 0 such measurements are no evidence.
struct MissUnits {
    float log_odds = 0.4F;  ///< an image of a stationary camera, or a ray, below 0
    float misses = 1.2F;    ///< a range of a cone, the largest of all kinds
    friend constexpr bool operator==(const MissUnits&, const MissUnits&) = default;
};
[[nodiscard]] MissUnits miss_units(const MappingConfig& config) noexcept;

/// Lower limits: the map forgets what lies beyond its clamps. Multiples of 0.01, none below 0.
struct FreeEvidence {
    /// Images (and ranges as rays) by the prior's log-odds; at most log_odds_min / miss_log_odds. An image of
    /// a moving camera counts moving_miss_log_odds / miss_log_odds.
    double images = 0.0;
    /// Ranges of cones by misses less hits; at most counts_max / miss_mass. With several kinds of cones a
    /// range of one with a smaller miss_mass counts less than 1.
    double beams = 0.0;

    [[nodiscard]] double sum() const noexcept { return images + beams; }
    friend bool operator==(const FreeEvidence&, const FreeEvidence&) = default;
};

/// Of a free voxel; of others without meaning.
[[nodiscard]] FreeEvidence free_evidence(const VoxelState& voxel, const MissUnits& units) noexcept;

}  // namespace octoskin
