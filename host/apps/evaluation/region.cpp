#include "host/apps/evaluation/region.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "host/core/mapping/voxel_lattice.hpp"

namespace octoskin::evaluation {
namespace {

constexpr double kRegionVoxelsMax = 50e6;

struct KeySpan {
    std::uint16_t first;
    std::uint16_t last;
};

/// The keys whose centres lie in [low, high], metres along one axis: as numbers, before it is known whether
/// they are keys.
struct Extent {
    double first;
    double last;
    [[nodiscard]] double count() const { return last - first + 1.0; }
    [[nodiscard]] bool is_within_map() const { return first >= 0.0 && last < kVoxelsPerAxis; }
};

Extent extent_between(double low, double high, double resolution_m) {
    return {std::ceil(low / resolution_m - 0.5) + kOriginKey,
            std::floor(high / resolution_m - 0.5) + kOriginKey};
}

KeySpan keys_between(double low, double high, double resolution_m) {
    const Extent extent = extent_between(low, high, resolution_m);
    assert(extent.is_within_map() && extent.count() >= 1.0);
    return {static_cast<std::uint16_t>(extent.first), static_cast<std::uint16_t>(extent.last)};
}

}  // namespace

std::optional<std::string> region_fault(const RegionConfig& config, double resolution_m,
                                        const Eigen::Isometry3d& T_map_base) {
    const auto fault = [&](const char* what) {
        return "the judged region (the scenario's `region`) " + std::string(what) + " at a resolution of " +
               std::to_string(resolution_m) + " m";
    };
    Extent box[3];
    for (int axis = 0; axis < 3; ++axis)
        box[axis] = extent_between(config.p_map_min[axis], config.p_map_max[axis], resolution_m);
    if (config.floor_top_m) {
        const Eigen::Vector3d p_map_floor = T_map_base * Eigen::Vector3d(0.0, 0.0, *config.floor_top_m);
        const double layer = std::floor(p_map_floor.z() / resolution_m) + kOriginKey;
        if (!(layer >= 0.0 && layer < kVoxelsPerAxis)) return fault("has its floor outside the map");
        box[2].first = std::max(box[2].first, layer + 1.0);
    }
    double voxels = 1.0;
    for (const Extent& extent : box) {
        if (!(extent.count() >= 1.0)) return fault("holds no voxel above its floor");
        if (!extent.is_within_map()) return fault("is not within the map");
        voxels *= extent.count();
    }
    if (voxels > kRegionVoxelsMax) return fault("has more than 50 million voxels");
    return std::nullopt;
}

std::uint16_t floor_layer(double floor_top_m, double resolution_m, const Eigen::Isometry3d& T_map_base) {
    const Eigen::Vector3d p_map_floor = T_map_base * Eigen::Vector3d(0.0, 0.0, floor_top_m);
    const auto key = VoxelLattice(resolution_m).key_of(p_map_floor.z());
    assert(key);
    return *key;
}

KeyBox region_of(const RegionConfig& config, double resolution_m, const Eigen::Isometry3d& T_map_base) {
    const auto x = keys_between(config.p_map_min.x(), config.p_map_max.x(), resolution_m);
    const auto y = keys_between(config.p_map_min.y(), config.p_map_max.y(), resolution_m);
    auto z = keys_between(config.p_map_min.z(), config.p_map_max.z(), resolution_m);
    if (config.floor_top_m) {
        const auto above =
            static_cast<std::uint16_t>(floor_layer(*config.floor_top_m, resolution_m, T_map_base) + 1);
        z.first = std::max(z.first, above);
        assert(z.first <= z.last);
    }
    return {{x.first, y.first, z.first}, {x.last, y.last, z.last}};
}

}  // namespace octoskin::evaluation
