// Divides space into bricks of 8 x 8 x 8 voxels: the lowest three levels of an octree, in Morton order.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "host/core/voxels/morton.hpp"
#include "host/core/voxels/voxel_lattice.hpp"

namespace octoskin {

inline constexpr unsigned kBrickHeight = 3;
inline constexpr int kBrickEdge = 1 << kBrickHeight;
inline constexpr std::size_t kBrickVoxels = std::size_t{1} << (3 * kBrickHeight);

/// The value of an unknown voxel is NaN, so that one load separates known from unknown. No term, clamp or
/// file can produce a NaN: all inputs are checked to be finite.
inline constexpr float kUnknownLogOdds = std::numeric_limits<float>::quiet_NaN();

/// The value of an unknown voxel, and the test for it.
template <class Value>
struct UnknownValue;
template <>
struct UnknownValue<float> {
    static constexpr float kValue = kUnknownLogOdds;
    [[nodiscard]] static bool is(float value) noexcept { return std::isnan(value); }
};
template <>
struct UnknownValue<std::uint16_t> {
    static constexpr std::uint16_t kValue = 0;
    [[nodiscard]] static bool is(std::uint16_t value) noexcept { return value == 0; }
};

/// One value for each voxel of a brick, in Morton order.
template <class Value>
using BrickValuesOf = std::array<Value, kBrickVoxels>;
using BrickValues = BrickValuesOf<float>;

/// A set of a brick's voxels: bit i of word w is voxel 64 w + i, in Morton order.
using BrickMask = std::array<std::uint64_t, kBrickVoxels / 64>;

/// A read-only view of a brick. It is valid until the owner changes the brick.
template <class Value>
struct BrickViewOf {
    const BrickValuesOf<Value>* values = nullptr;  ///< null: all voxels have the same value
    Value value = UnknownValue<Value>::kValue;     ///< the value of all voxels if `values` is null

    [[nodiscard]] Value at(std::size_t cell) const noexcept { return values ? (*values)[cell] : value; }
    /// True if no voxel of the brick is known.
    [[nodiscard]] bool is_unknown() const noexcept {
        return values == nullptr && UnknownValue<Value>::is(value);
    }
};
using BrickView = BrickViewOf<float>;

/// spread_bits() of the coordinates within a brick.
inline constexpr std::array<std::uint8_t, kBrickEdge> kSpreadInBrick = {0, 1, 8, 9, 64, 65, 72, 73};

/// Index of a voxel in its brick, in Morton order.
[[nodiscard]] constexpr std::size_t cell_of(VoxelKey key) noexcept {
    return static_cast<std::size_t>(kSpreadInBrick[key.x & 7U] | (kSpreadInBrick[key.y & 7U] << 1U) |
                                    (kSpreadInBrick[key.z & 7U] << 2U));
}

/// Morton code of the first voxel of the brick that contains `key`.
[[nodiscard]] constexpr MortonCode brick_of(VoxelKey key) noexcept {
    return morton_of(key) & ~MortonCode{kBrickVoxels - 1};
}

[[nodiscard]] constexpr bool are_of_one_brick(VoxelKey a, VoxelKey b) noexcept {
    return ((a.x ^ b.x) | (a.y ^ b.y) | (a.z ^ b.z)) >> kBrickHeight == 0;
}

}  // namespace octoskin
