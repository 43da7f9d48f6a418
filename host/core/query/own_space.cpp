#include "host/core/query/own_space.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace octoskin {
namespace {

/// Terms that clamp whatever they are added to at the least there is.
void list_own(const FusedMap& map, const PosedCapsule& capsule, double margin_m,
              std::vector<VoxelUpdate>& updates) {
    const MapConfig& config = map.config();
    const float all_the_way = config.log_odds_min - config.log_odds_max;
    const double reach_m = capsule.radius_m + margin_m;
    const auto lowest = map.key_of(capsule.p_a.cwiseMin(capsule.p_b).array() - reach_m);
    const auto highest = map.key_of(capsule.p_a.cwiseMax(capsule.p_b).array() + reach_m);
    if (!lowest || !highest) return;
    for (unsigned z = lowest->z; z <= highest->z; ++z) {
        for (unsigned y = lowest->y; y <= highest->y; ++y) {
            for (unsigned x = lowest->x; x <= highest->x; ++x) {
                const VoxelKey key{static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y),
                                   static_cast<std::uint16_t>(z)};
                const double outside_m = distance_to_surface(capsule, map.centre_of(key));
                if (!(outside_m <= margin_m)) continue;
                const Occupancy state = map.occupancy(key);
                const bool is_old = state == Occupancy::free && map.is_stale(key);
                if (is_old || state == Occupancy::unknown ||
                    (state == Occupancy::occupied && outside_m <= 0.0))
                    updates.push_back({key, all_the_way});
            }
        }
    }
}

}  // namespace

std::size_t free_own_space(FusedMap& map, std::span<const PosedCapsule> capsules, double margin_m) {
    std::size_t freed = 0;
    std::vector<VoxelUpdate> updates;
    for (const PosedCapsule& capsule : capsules) {
        updates.clear();
        list_own(map, capsule, margin_m, updates);
        const Evidence is_free = evidence_of(updates, SensorKind::none);
        map.forget_counts_of(is_free);  // or what ranges counted there would mark it all the same
        map.apply(is_free);
        freed += updates.size();
    }
    return freed;
}

}  // namespace octoskin
