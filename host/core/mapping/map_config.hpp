// Properties of a map, independent of its measurements.
#pragma once

#include <cstdint>

#include "host/core/mapping/age_model.hpp"
#include "host/core/mapping/cone_model.hpp"

namespace octoskin {

struct MapConfig {
    double resolution_m = 0.04;
    float log_odds_min = -2.0F;
    float log_odds_max = 3.5F;
    /// Clamps of an image's terms only. After an image, a voxel that all its rays pass is at most at
    /// `log_odds_passed_max`, and a voxel that it hits at least at `log_odds_hit_min`. An object that appears
    /// or leaves thus shows after a few images, however long the voxel had the other state.
    float log_odds_passed_max = 100.0F;
    float log_odds_hit_min = -100.0F;
    /// A voxel is occupied at or above this log-odds.
    float log_odds_occupied = 0.0F;
    /// Beyond this limit, the map takes no new space; existing bricks are still updated. Room is computed as
    /// if each voxel had its own value, because each may get one.
    std::uint32_t memory_max_mib = 800;
    /// Parameters of the counts of range sensors with a cone. Counts may take up to 3/16 of `memory_max_mib`
    /// in addition, and the voxels' time stamps 9/16.
    CountModel counts = {};
    AgeModel age = {};
    friend bool operator==(const MapConfig&, const MapConfig&) = default;
};

}  // namespace octoskin
