// Small maps for the file tests.
#pragma once

#include <random>
#include <string>
#include <vector>

#include "host/core/mapping/fused_map.hpp"

namespace octoskin::samples {

inline constexpr std::uint16_t kZero = 32768;

inline VoxelKey key(int x, int y, int z) {
    return {static_cast<std::uint16_t>(kZero + x), static_cast<std::uint16_t>(kZero + y),
            static_cast<std::uint16_t>(kZero + z)};
}

/// One occupied, one free voxel and a pruned cube of two voxels' edge.
inline FusedMap small_map() {
    FusedMap map(MapConfig{});
    map.apply(std::vector<VoxelUpdate>{{key(0, 0, 0), 0.75F}, {key(-3, 5, 1), -0.5F}});
    for (int i = 0; i < 8; ++i) {
        map.apply(std::vector<VoxelUpdate>{{key(8 + (i & 1), 8 + (i >> 1 & 1), 8 + (i >> 2)), -0.4F}});
    }
    return map;
}

/// Blobs of clamped, equal and odd values: pruning happens on several levels.
inline FusedMap random_map(unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_int_distribution<int> corner(-3, 2);
    std::uniform_int_distribution<int> edge(1, 20);
    std::uniform_int_distribution<int> value(0, 3);
    constexpr float kValues[] = {-9.0F, -0.4F, 0.3F, 9.0F};
    FusedMap map(MapConfig{});
    std::vector<VoxelUpdate> updates;
    for (int blob = 0; blob < 8; ++blob) {
        const int x0 = 8 * corner(random), y0 = 8 * corner(random), z0 = 8 * corner(random);
        const int size = edge(random);
        const float term = kValues[value(random)];
        for (int i = 0; i < size * size * size; ++i) {
            updates.push_back({key(x0 + i % size, y0 + i / size % size, z0 + i / size / size), term});
        }
    }
    map.apply(updates);
    return map;
}

}  // namespace octoskin::samples
