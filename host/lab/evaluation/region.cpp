#include "host/lab/evaluation/region.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "host/core/voxels/voxel_lattice.hpp"

namespace octoskin::evaluation {
namespace {

constexpr double kRegionVoxelsMax = 50e6;

/// First and last key along one axis, as numbers: they may lie outside the range of keys.
struct Extent {
    double first;
    double last;
    [[nodiscard]] double count() const { return last - first + 1.0; }
    [[nodiscard]] bool is_within_map() const { return first >= 0.0 && last < kVoxelsPerAxis; }
};
using Extents = std::array<Extent, 3>;

std::optional<std::uint16_t> layer_of_floor(double floor_top_m, double resolution_m,
                                            const Eigen::Isometry3d& T_map_base) {
    const Eigen::Vector3d p_map_floor = T_map_base * Eigen::Vector3d(0.0, 0.0, floor_top_m);
    return VoxelLattice(resolution_m).key_of(p_map_floor.z());
}

/// The keys whose centres lie in the box, above the floor; empty if the floor is outside the map.
std::optional<Extents> extents_of(const RegionConfig& config, double resolution_m,
                                  const Eigen::Isometry3d& T_map_base) {
    Extents box{};
    for (std::size_t axis = 0; axis < box.size(); ++axis) {
        const auto i = static_cast<Eigen::Index>(axis);
        box[axis] = {std::ceil(config.p_map_min[i] / resolution_m - 0.5) + kOriginKey,
                     std::floor(config.p_map_max[i] / resolution_m - 0.5) + kOriginKey};
    }
    if (!config.floor_top_m) return box;
    const auto floor = layer_of_floor(*config.floor_top_m, resolution_m, T_map_base);
    if (!floor) return std::nullopt;
    box[2].first = std::max(box[2].first, *floor + 1.0);
    return box;
}

}  // namespace

std::optional<Error> region_fault(const RegionConfig& config, double resolution_m,
                                  const Eigen::Isometry3d& T_map_base) {
    const auto fault = [&](ErrorCode code, const char* what) {
        return Error{.code = code,
                     .what = fmt::format("the judged region {} at a resolution of {} m", what, resolution_m),
                     .remedy = "change the region, or the resolution"};
    };
    const auto box = extents_of(config, resolution_m, T_map_base);
    if (!box) return fault(ErrorCode::out_of_range, "has its floor outside the map");
    double voxels = 1.0;
    for (const Extent& extent : *box) {
        if (!(extent.count() >= 1.0)) return fault(ErrorCode::no_content, "holds no voxel above its floor");
        if (!extent.is_within_map()) return fault(ErrorCode::out_of_range, "is not within the map");
        voxels *= extent.count();
    }
    if (voxels > kRegionVoxelsMax) return fault(ErrorCode::limit_exceeded, "has more than 50 million voxels");
    return std::nullopt;
}

std::uint16_t floor_layer(double floor_top_m, double resolution_m, const Eigen::Isometry3d& T_map_base) {
    const auto layer = layer_of_floor(floor_top_m, resolution_m, T_map_base);
    assert(layer);
    return *layer;
}

KeyBox region_of(const RegionConfig& config, double resolution_m, const Eigen::Isometry3d& T_map_base) {
    assert(!region_fault(config, resolution_m, T_map_base));
    const Extents box = extents_of(config, resolution_m, T_map_base).value();
    const auto key = [](double number) { return static_cast<std::uint16_t>(number); };
    return {{key(box[0].first), key(box[1].first), key(box[2].first)},
            {key(box[0].last), key(box[1].last), key(box[2].last)}};
}

}  // namespace octoskin::evaluation
