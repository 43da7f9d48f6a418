#include "host/core/query/nearest_search.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "host/core/bricks/brick_sets.hpp"
#include "host/core/bricks/cube_parts.hpp"

namespace octoskin {
namespace {

constexpr std::uint64_t kAllParts = ~std::uint64_t{0};

double steps_of(double distance_m) {
    return std::floor(distance_m / kDistanceStep_m + 0.5);
}

}  // namespace

NearestSearch::NearestSearch(const FusedMap& map, const SearchRequest& request) noexcept
    : map_(map),
      resolution_m_(map.resolution_m()),
      segment_(request.p_a, request.p_b),
      lowest_(request.p_a.cwiseMin(request.p_b)),
      highest_(request.p_a.cwiseMax(request.p_b)),
      wanted_(request.wanted) {
    const double reach_m = std::max(request.occupied_reach_m, request.unknown_reach_m);
    const Eigen::Vector3d lowest = lowest_.array() - reach_m;
    const Eigen::Vector3d highest = highest_.array() + reach_m;
    const double bound_m = kOriginKey * map.resolution_m();
    is_outside_ = lowest.minCoeff() < -bound_m || highest.maxCoeff() > bound_m;
    meets_octree_ = lowest.maxCoeff() <= bound_m && highest.minCoeff() >= -bound_m;
    box_ = {key_near(lowest, resolution_m_), key_near(highest, resolution_m_)};
    occupied_.reach_m = occupied_.limit_m = request.occupied_reach_m;
    unknown_.reach_m = unknown_.limit_m = request.unknown_reach_m;
}

void NearestSearch::run() noexcept {
    if (meets_octree_ && !(wanted_ == SearchFor::any && is_outside_)) look(map_.space());
}

double NearestSearch::distance_to(const VoxelCube& cube) const {
    return segment_.distance(centre_of(cube, resolution_m_), half_edge_of(cube, resolution_m_));
}

/// If only the worst voxel is wanted, the limit of unknown voxels never exceeds that of occupied ones:
/// unknown voxels do not end the search for occupied ones.
double NearestSearch::limit_m() const noexcept {
    return std::max(occupied_.limit_m, unknown_.limit_m);
}

bool NearestSearch::is_done() const {
    if (wanted_ == SearchFor::any && (occupied_.found.voxel || unknown_.found.voxel)) return true;
    return limit_m() == kNever;
}

void NearestSearch::look(const BrickTree::Space& space) {
    if (!space.has_parts()) return look_into(space.cube(), space.bricks());
    for (auto parts = parts_in(space.cube(), box_); parts != 0 && !is_done(); parts &= parts - 1) {
        const auto part = space.part(static_cast<std::size_t>(std::countr_zero(parts)));
        if (!is_surely_beyond(part.cube(), limit_m())) look(part);
    }
}

void NearestSearch::look_into(const VoxelCube& cube, const BrickView& bricks) {
    if (bricks.values != nullptr) return look_into_brick(cube, *bricks.values);
    if (std::isnan(bricks.value)) return take(unknown_, cube);
    if (map_.occupancy_of(bricks.value) == Occupancy::occupied) take(occupied_, cube);
}

void NearestSearch::look_into_brick(const VoxelCube& brick, const BrickValues& values) {
    const MortonCode first = morton_of(brick.lowest);
    for (std::size_t word = 0; word < kBrickVoxels / 64 && !is_done(); ++word) {
        const VoxelCube cube{key_of_morton(first + 64 * word), 2};
        if (!do_meet(cube, box_)) continue;
        const WordSets sets = sets_of(values, word, map_.config().log_odds_occupied);
        take_some(occupied_, cube, sets.at_least);
        take_some(unknown_, cube, ~sets.known);
    }
}

void NearestSearch::look_at(const VoxelCube& brick, const BrickSites& sites) noexcept {
    if (is_surely_beyond(brick, limit_m())) return;
    for (std::size_t word = 0; word < kBrickVoxels / 64; ++word) {
        if ((sites.occupied[word] | sites.unknown[word]) == 0) continue;  // usual case
        const auto along = [word](std::uint16_t lowest, unsigned axis) {
            return static_cast<std::uint16_t>(lowest + 4 * (word >> axis & 1U));
        };
        const VoxelCube cube{{along(brick.lowest.x, 0), along(brick.lowest.y, 1), along(brick.lowest.z, 2)},
                             2};
        const auto look_at_some = [&](Nearest& nearest, std::uint64_t voxels) {
            if (is_near(nearest, cube, voxels)) take_each(nearest, cube, facing(cube, voxels));
        };
        look_at_some(occupied_, sites.occupied[word]);
        look_at_some(unknown_, sites.unknown[word]);
    }
}

/// The voxels of a word without another one in front of them: where the whole segment is on one side of the
/// word, a neighbour on that side is no further from any point of the segment.
std::uint64_t NearestSearch::facing(const VoxelCube& word, std::uint64_t voxels) const {
    if ((voxels & (voxels - 1)) == 0) return voxels;
    const Eigen::Vector3d corner =
        resolution_m_ *
        Eigen::Vector3d(word.lowest.x - kOriginKey, word.lowest.y - kOriginKey, word.lowest.z - kOriginKey);
    std::uint64_t behind = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto along = static_cast<Eigen::Index>(axis);
        if (highest_[along] <= corner[along] + resolution_m_) behind |= parts_after(voxels, axis);
        if (lowest_[along] >= corner[along] + 3.0 * resolution_m_) behind |= parts_before(voxels, axis);
    }
    return voxels & ~behind;
}

void NearestSearch::take_some(Nearest& nearest, const VoxelCube& word, std::uint64_t voxels) {
    if (!is_near(nearest, word, voxels)) return;
    if (voxels == kAllParts) return take(nearest, word);
    take_each(nearest, word, voxels & parts_in(word, box_));
}

void NearestSearch::take_each(Nearest& nearest, const VoxelCube& word, std::uint64_t voxels) {
    for (; voxels != 0; voxels &= voxels - 1)
        take(nearest, part_of(word, static_cast<std::size_t>(std::countr_zero(voxels))));
}

/// Takes a cube whose voxels all have the state. The distance of the nearest voxel is that of the cube, so
/// descending to it needs no search.
void NearestSearch::take(Nearest& nearest, VoxelCube cube) {
    if (nearest.limit_m == kNever || is_surely_beyond(cube, nearest.limit_m)) return;
    const double distance_m = distance_to(cube);
    double steps = steps_of(distance_m);
    Found& found = nearest.found;
    if (found.voxel ? steps * kDistanceStep_m >= found.distance_m : distance_m > nearest.reach_m) return;
    while (cube.height > 0) cube = nearest_eighth(cube, steps);
    found = {cube.lowest, steps * kDistanceStep_m};
    nearest.limit_m = steps > 0.0 ? found.distance_m : kNever;
    if (&nearest != &occupied_) return;
    unknown_.limit_m = wanted_ == SearchFor::both ? std::min(unknown_.limit_m, nearest.limit_m) : kNever;
}

/// The first of the nearest eighths. `steps` becomes its distance.
VoxelCube NearestSearch::nearest_eighth(const VoxelCube& cube, double& steps) const {
    const unsigned height = cube.height - 1;
    const MortonCode first = morton_of(cube.lowest);
    VoxelCube nearest;
    steps = std::numeric_limits<double>::infinity();
    for (MortonCode child = 0; child < 8; ++child) {
        const VoxelCube eighth{key_of_morton(first + (child << (3 * height))), height};
        const double steps_to_it = steps_of(distance_to(eighth));
        if (steps_to_it >= steps) continue;
        nearest = eighth;
        steps = steps_to_it;
    }
    return nearest;
}

}  // namespace octoskin
