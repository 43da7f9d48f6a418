#include "host/bridge/published/map_view.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>
#include <utility>

#include "host/core/bricks/brick.hpp"
#include "host/core/voxels/key_box.hpp"

namespace octoskin::bridge {
namespace {

/// The voxels whose centre may be in the box; empty if it is outside the octree.
std::optional<KeyBox> keys_in(const VoxelLattice& lattice, const Eigen::AlignedBox3d& box) {
    const double bound = (kOriginKey - 1) * lattice.resolution_m();
    const Eigen::Vector3d low = box.min().cwiseMax(-bound);
    const Eigen::Vector3d high = box.max().cwiseMin(bound);
    if ((low.array() > high.array()).any()) return std::nullopt;
    const auto lowest = lattice.key_of(low);
    const auto highest = lattice.key_of(high);
    if (!lowest || !highest) return std::nullopt;
    return KeyBox{*lowest, *highest};
}

/// Visits the codes of the bricks that meet the box.
template <class Visit>
void for_each_brick(const KeyBox& box, Visit visit) {
    const auto floor = [](int key) { return key & ~(kBrickEdge - 1); };
    for (int z = floor(box.lowest.z); z <= box.highest.z; z += kBrickEdge)
        for (int y = floor(box.lowest.y); y <= box.highest.y; y += kBrickEdge)
            for (int x = floor(box.lowest.x); x <= box.highest.x; x += kBrickEdge)
                visit(brick_of({static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y),
                                static_cast<std::uint16_t>(z)}));
}

/// The same, of those in which the map knows something. O(the fewer of the box's bricks and the map's).
template <class Visit>
void for_each_known_brick(const FusedMap& map, const KeyBox& box, Visit visit) {
    const auto bricks_along = [](int lowest, int highest) { return (highest - lowest) / kBrickEdge + 2.0; };
    const double in_box = bricks_along(box.lowest.x, box.highest.x) *
                          bricks_along(box.lowest.y, box.highest.y) *
                          bricks_along(box.lowest.z, box.highest.z);
    if (in_box < static_cast<double>(map.layers().log_odds.bricks()))
        return for_each_brick(box, [&](MortonCode brick) {
            if (!map.brick(brick).is_unknown()) visit(brick);
        });
    for (const MapBrick& brick : map.bricks())
        if (do_meet({key_of_morton(brick.first), kBrickHeight}, box)) visit(brick.first);
}

Eigen::AlignedBox3d box_around(const Solid& solid, double margin_m) {
    const Eigen::Vector3d half = half_extent(solid);
    const Eigen::Vector3d half_map = solid.T_map_solid.linear().cwiseAbs() * half;
    const Eigen::Vector3d grown = half_map + Eigen::Vector3d::Constant(margin_m);
    return {solid.T_map_solid.translation() - grown, solid.T_map_solid.translation() + grown};
}

FusedMap with_log_odds(const FusedMap& map, BrickTree log_odds) {
    MapLayers layers = map.layers();
    layers.log_odds = std::move(log_odds);
    layers.counts = {};
    return {map.config(), std::move(layers), map.has_undated()};
}

/// Changes the voxels of a brick for which `wanted` returns a value.
template <class Wanted>
void rewrite(BrickTree& tree, MortonCode brick, Wanted wanted) {
    const BrickView before = tree.find(brick);
    BrickValues values;
    bool is_changed = false;
    for (std::size_t cell = 0; cell < kBrickVoxels; ++cell) {
        values[cell] = before.at(cell);
        if (const std::optional<float> next = wanted(cell, values[cell])) {
            values[cell] = *next;
            is_changed = true;
        }
    }
    if (is_changed) tree.open(brick) = values;
}

}  // namespace

double voxels_in(const Eigen::AlignedBox3d& box_map, double resolution_m) noexcept {
    return (box_map.sizes() / resolution_m).array().ceil().prod();
}

CutMap without(const FusedMap& map, std::span<const Solid> solids, double padding_m, std::uint64_t work_max) {
    // Each brick has 512 voxels to look at.
    constexpr std::uint64_t kWorkOfBrick = 16;
    BrickTree tree = map.layers().log_odds;
    std::size_t left_in = 0;
    std::uint64_t work = 0;
    // A voxel comes within the padding if its centre does within half its diagonal more.
    const double reach = padding_m + 0.5 * std::sqrt(3.0) * map.resolution_m();
    for (const Solid& solid : solids) {
        const Eigen::AlignedBox3d box = box_around(solid, reach);
        const auto keys = box.isEmpty() ? std::nullopt : keys_in(map.lattice(), box);
        if (!keys) continue;
        for_each_known_brick(map, *keys, [&](MortonCode brick) {
            work += kWorkOfBrick;
            if (work > work_max) return;
            rewrite(tree, brick, [&](std::size_t cell, float log_odds) -> std::optional<float> {
                if (std::isnan(log_odds) || map.occupancy_of(log_odds) != Occupancy::occupied) return {};
                work += work_for(solid);
                if (work > work_max) return {};
                if (!is_within(solid, map.centre_of(key_of_morton(brick + cell)), reach)) return {};
                return kUnknownLogOdds;
            });
        });
        left_in += work > work_max ? 1U : 0U;
    }
    return {with_log_odds(map, std::move(tree)), left_in};
}

FusedMap with_unknown_occupied(const FusedMap& map, const Eigen::AlignedBox3d& box_map,
                               std::span<const PosedCapsule> body_map, double own_space_m) {
    assert(voxels_in(box_map, map.resolution_m()) <= kUnknownVoxelsMax);
    BrickTree tree = map.layers().log_odds;
    const auto keys = keys_in(map.lattice(), box_map);
    if (!keys) return map.copy();
    const auto is_own = [&](const Eigen::Vector3d& p) {
        return std::ranges::any_of(body_map, [&](const PosedCapsule& capsule) {
            return distance_to_surface(capsule, p) <= own_space_m;
        });
    };
    for_each_brick(*keys, [&](MortonCode brick) {
        rewrite(tree, brick, [&](std::size_t cell, float log_odds) -> std::optional<float> {
            if (!std::isnan(log_odds)) return {};
            const Eigen::Vector3d centre = map.centre_of(key_of_morton(brick + cell));
            if (!box_map.contains(centre) || is_own(centre)) return {};
            return map.config().log_odds_max;
        });
    });
    return with_log_odds(map, std::move(tree));
}

}  // namespace octoskin::bridge
