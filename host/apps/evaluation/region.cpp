#include "host/apps/evaluation/region.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "host/core/mapping/voxel_lattice.hpp"

namespace octoskin::evaluation {
namespace {

struct KeySpan {
    std::uint16_t first;
    std::uint16_t last;
};

/// The keys whose centres lie in [low, high], metres along one axis.
KeySpan keys_between(double low, double high, double resolution_m) {
    const double first = std::ceil(low / resolution_m - 0.5) + kOriginKey;
    const double last = std::floor(high / resolution_m - 0.5) + kOriginKey;
    assert(first >= 0.0 && last < kVoxelsPerAxis && first <= last);
    return {static_cast<std::uint16_t>(first), static_cast<std::uint16_t>(last)};
}

}  // namespace

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
