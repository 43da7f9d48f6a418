#include "host/lab/evaluation/unknown_space.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace octoskin::evaluation {
namespace {

constexpr Nanoseconds kEvery{250'000'000};
constexpr double kPocketMin_m3 = 1e-3;  // one litre: smaller pockets do not matter to a planner

double voxel_m3(const FusedMap& map) {
    return std::pow(map.resolution_m(), 3);
}

/// Does not search for pockets, which would take longer.
std::optional<UnknownPockets> count_unknown(const FusedMap& map, const PocketRegion& region) {
    return UnknownPockets::find(map, region, std::numeric_limits<std::size_t>::max());
}

/// The region must lie in the octree.
UnknownColumns columns_of(const FusedMap& map, const PocketRegion& region) {
    const double edge_m = map.resolution_m();
    const auto low = map.key_of(region.centre.array() - region.radius_m);
    const auto high = map.key_of(region.centre.array() + region.radius_m);
    if (!low || !high) return {};
    const auto side = static_cast<std::size_t>(std::max(high->x - low->x, high->y - low->y)) + 1;
    const Eigen::Vector3d corner = map.centre_of(*low) - region.centre;
    UnknownColumns columns{.edge_m = edge_m,
                           .side = side,
                           .low_x_m = corner.x() - 0.5 * edge_m,
                           .low_y_m = corner.y() - 0.5 * edge_m,
                           .unknown_m = std::vector<double>(side * side)};
    VoxelKey key = *low;
    for (std::size_t column = 0; column < columns.unknown_m.size(); ++column) {
        if (low->x + column % side > high->x || low->y + column / side > high->y) continue;
        key.x = static_cast<std::uint16_t>(low->x + column % side);
        key.y = static_cast<std::uint16_t>(low->y + column / side);
        for (unsigned z = low->z; z <= high->z; ++z) {
            key.z = static_cast<std::uint16_t>(z);
            if (is_within(region, map.centre_of(key)) && map.occupancy(key) == Occupancy::unknown)
                columns.unknown_m[column] += edge_m;
        }
    }
    return columns;
}

}  // namespace

void UnknownSpaceMeter::see(HostTime captured, const FusedMap* depth, const FusedMap& fused) {
    if (!begin_) begin_ = next_ = last_ = captured;
    if (captured > last_) last_ = captured;
    if (captured < next_) return;
    sample(captured, depth, fused);
    next_ = captured + kEvery;
}

void UnknownSpaceMeter::sample(HostTime captured, const FusedMap* depth, const FusedMap& fused) {
    const auto of_fused = count_unknown(fused, space_.region);
    if (!of_fused) return;
    space_.region_m3 = static_cast<double>(of_fused->region_voxels()) * voxel_m3(fused);
    UnknownSample sample;
    sample.t_s = std::chrono::duration<double>(captured - *begin_).count();
    sample.fused_m3 = static_cast<double>(of_fused->unknown_voxels()) * voxel_m3(fused);
    if (depth != nullptr) {
        if (const auto of_depth = count_unknown(*depth, space_.region))
            sample.depth_m3 = static_cast<double>(of_depth->unknown_voxels()) * voxel_m3(*depth);
    }
    space_.samples.push_back(sample);
}

UnknownSpace UnknownSpaceMeter::finish(const FusedMap* depth, const FusedMap& fused) {
    if (begin_) sample(last_, depth, fused);
    const auto voxels_min = static_cast<std::size_t>(std::ceil(kPocketMin_m3 / voxel_m3(fused)));
    if (const auto found = UnknownPockets::find(fused, space_.region, voxels_min))
        space_.pockets = found->pockets();
    if (!space_.samples.empty()) {
        space_.fused_columns = columns_of(fused, space_.region);
        if (depth != nullptr) space_.depth_columns = columns_of(*depth, space_.region);
    }
    return std::move(space_);
}

}  // namespace octoskin::evaluation
