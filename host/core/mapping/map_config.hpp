// What a map is like, whatever goes into it.
#pragma once

#include <cstdint>

#include "host/core/mapping/age_model.hpp"
#include "host/core/mapping/cone_model.hpp"

namespace octoskin {

struct MapConfig {
    double resolution_m = 0.04;
    float log_odds_min = -2.0F;
    float log_odds_max = 3.5F;
    /// Clamps of an image's terms alone: what its rays all pass has no more after it, and what it hits no
    /// less, so that whatever has gone or come is told by a few images, however long it was otherwise.
    float log_odds_passed_max = 100.0F;
    float log_odds_hit_min = -100.0F;
    /// A voxel is occupied at or above this log-odds.
    float log_odds_occupied = 0.0F;
    /// Beyond this the map takes no new space; what it holds goes on being updated. Space counts as if each
    /// of its voxels had a value of its own, for each may come to have one.
    std::uint32_t memory_max_mib = 800;
    /// What counts of range sensors that see a cone are worth. They may take up to 3/16 of `memory_max_mib`
    /// more, and the voxels' times 9/16.
    CountModel counts = {};
    AgeModel age = {};
    friend bool operator==(const MapConfig&, const MapConfig&) = default;
};

}  // namespace octoskin
