// Small maps for the file tests.
#pragma once

#include <random>
#include <string>
#include <vector>

#include "host/core/mapping/fused_map.hpp"
#include "tests/support/evidence.hpp"

namespace octoskin::samples {

inline constexpr std::uint16_t kZero = 32768;

inline VoxelKey key(int x, int y, int z) {
    return {static_cast<std::uint16_t>(kZero + x), static_cast<std::uint16_t>(kZero + y),
            static_cast<std::uint16_t>(kZero + z)};
}

/// One occupied, one free voxel and a pruned cube of two voxels' edge.
inline FusedMap small_map() {
    FusedMap map(MapConfig{});
    feed(map, std::vector<VoxelUpdate>{{key(0, 0, 0), 0.75F}, {key(-3, 5, 1), -0.5F}});
    for (int i = 0; i < 8; ++i) {
        feed(map, std::vector<VoxelUpdate>{{key(8 + (i & 1), 8 + (i >> 1 & 1), 8 + (i >> 2)), -0.4F}});
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
    feed(map, updates);
    return map;
}

/// Over 100,000 voxels from one end of the octree to the other: cubes that are pruned up to a height of 5,
/// single voxels that nothing is near to, and odd values in between.
inline FusedMap far_map(unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_int_distribution<unsigned> place(0, 65535);
    std::uniform_int_distribution<unsigned> height(2, 5);
    std::uniform_real_distribution<float> term(-2.5F, 4.0F);
    FusedMap map(MapConfig{});
    const auto axis = [&](unsigned low_bits) {
        return static_cast<std::uint16_t>(place(random) >> low_bits << low_bits);
    };
    for (int cube = 0; cube < 24; ++cube) {
        const unsigned bits = height(random);
        const VoxelKey lowest{axis(bits), axis(bits), axis(bits)};
        if (!map.set_cube({lowest, bits}, term(random))) return map;
        const auto within = [&] { return static_cast<std::uint16_t>(place(random) & ((1U << bits) - 1U)); };
        std::vector<VoxelUpdate> updates;
        for (int i = 0; i < 6 * (cube % 3); ++i) {
            const auto at = [&](std::uint16_t from) { return static_cast<std::uint16_t>(from + within()); };
            updates.push_back({{at(lowest.x), at(lowest.y), at(lowest.z)}, term(random)});
        }
        for (int i = 0; i < 200; ++i) updates.push_back({{axis(0), axis(0), axis(0)}, term(random)});
        feed(map, updates);
    }
    return map;
}

}  // namespace octoskin::samples
