#include "host/core/query/own_space.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "host/core/mapping/voxel_brick.hpp"

namespace octoskin {
namespace {

/// Corners of the box around a capsule, both included.
struct VoxelBox {
    VoxelKey lowest;
    VoxelKey highest;
};

/// Empty if the box reaches out of the octree, or a number is not finite.
std::optional<VoxelBox> box_about(const FusedMap& map, const PosedCapsule& capsule, double margin_m) {
    const double reach_m = capsule.radius_m + margin_m;
    const auto lowest = map.key_of(capsule.p_a.cwiseMin(capsule.p_b).array() - reach_m);
    const auto highest = map.key_of(capsule.p_a.cwiseMax(capsule.p_b).array() + reach_m);
    if (!lowest || !highest) return std::nullopt;
    return VoxelBox{*lowest, *highest};
}

std::uint64_t voxels_of(const VoxelBox& box) {
    // A product of three numbers of at most 2^16.
    return (box.highest.x - box.lowest.x + 1ULL) * (box.highest.y - box.lowest.y + 1ULL) *
           (box.highest.z - box.lowest.z + 1ULL);
}

/// Capsules, the margin around them, and the test for the voxels to be freed.
struct Region {
    std::span<const PosedCapsule> capsules;
    double margin_m = 0.0;
    /// Called for a voxel whose centre is within `margin_m` of the capsule.
    std::function<bool(const FusedMap& map, const VoxelKey& key, const PosedCapsule& capsule)> is_freed;
};

/// Unknown, stale, or free with too little evidence.
bool is_doubtful(const FusedMap& map, const VoxelKey& key, const FreeDemand& demand) {
    const Occupancy state = map.occupancy(key);
    if (state != Occupancy::free) return state == Occupancy::unknown;
    return map.is_stale(key) || (demand.sum_min > 0.0 && !demand.is_met_by(free_evidence(
                                                             voxel_state(map.layers(), key), demand.units)));
}

/// A capsule is convex, so it contains a cube if it contains the corners.
bool holds_cube(const PosedCapsule& capsule, const Eigen::Vector3d& centre, double edge_m) {
    for (const double x : {-0.5, 0.5}) {
        for (const double y : {-0.5, 0.5}) {
            for (const double z : {-0.5, 0.5}) {
                const Eigen::Vector3d corner = centre + edge_m * Eigen::Vector3d(x, y, z);
                if (!(distance_to_surface(capsule, corner) <= 0.0)) return false;
            }
        }
    }
    return true;
}

/// The object that marked a voxel occupied may be in any part of it.
bool is_occupied_within(const FusedMap& map, const VoxelKey& key, const PosedCapsule& capsule) {
    return map.occupancy(key) == Occupancy::occupied &&
           holds_cube(capsule, map.centre_of(key), map.resolution_m());
}

/// Lists the voxels of the layers from `z_begin` to `z_last`, with terms that clamp each value at the
/// minimum.
void list_own(const FusedMap& map, const Region& region, const PosedCapsule& capsule, const VoxelBox& box,
              unsigned z_begin, unsigned z_last, std::vector<VoxelUpdate>& updates) {
    const float all_the_way = map.config().log_odds_min - map.config().log_odds_max;
    for (unsigned z = z_begin; z <= z_last; ++z) {
        for (unsigned y = box.lowest.y; y <= box.highest.y; ++y) {
            for (unsigned x = box.lowest.x; x <= box.highest.x; ++x) {
                const VoxelKey key{static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y),
                                   static_cast<std::uint16_t>(z)};
                const bool is_near = distance_to_surface(capsule, map.centre_of(key)) <= region.margin_m;
                if (is_near && region.is_freed(map, key, capsule)) updates.push_back({key, all_the_way});
            }
        }
    }
}

/// Number of freed voxels; empty if `is_ending` returned true.
std::optional<std::size_t> free_region(FusedMap& map, const Region& region,
                                       const std::function<bool()>& is_ending) {
    std::size_t freed = 0;
    std::vector<VoxelUpdate> updates;
    for (const PosedCapsule& capsule : region.capsules) {
        const auto box = box_about(map, capsule, region.margin_m);
        if (!box) continue;
        // One layer of bricks at a time: this bounds the delay of ending and the memory of the list.
        unsigned z_last = 0;
        for (unsigned z = box->lowest.z; z <= box->highest.z; z = z_last + 1) {
            if (is_ending()) return std::nullopt;
            z_last = std::min<unsigned>(z | (unsigned{kBrickEdge} - 1U), box->highest.z);
            updates.clear();
            list_own(map, region, capsule, *box, z, z_last, updates);
            const Evidence is_free = evidence_of(updates, SensorKind::none);
            map.clear_counts_of(is_free);  // otherwise counts from ranges could mark it occupied again
            map.apply(is_free);
            freed += updates.size();
        }
    }
    return freed;
}

std::uint64_t voxels_of(const FusedMap& map, const Region& region) {
    std::uint64_t voxels = 0;
    for (const PosedCapsule& capsule : region.capsules) {
        if (const auto box = box_about(map, capsule, region.margin_m)) voxels += voxels_of(*box);
    }
    return voxels;
}

}  // namespace

std::optional<std::size_t> free_own_space(FusedMap& map, const OwnBody& body, double margin_m,
                                          const std::function<bool()>& is_ending, const FreeDemand& demand) {
    const Region about{body.around, margin_m,
                       [&demand](const FusedMap& in, const VoxelKey& key, const PosedCapsule&) {
                           return is_doubtful(in, key, demand);
                       }};
    const Region within{body.certain, 0.0, is_occupied_within};
    if (voxels_of(map, about) + voxels_of(map, within) > kOwnSpaceVoxelsMax) return std::nullopt;
    const auto unknown = free_region(map, about, is_ending);
    const auto occupied = unknown ? free_region(map, within, is_ending) : std::nullopt;
    if (!occupied) return std::nullopt;
    return *unknown + *occupied;
}

}  // namespace octoskin
