// Morton order interleaves the bits of x, y and z, with x lowest. It is the depth-first order of an octree
// whose children are numbered as in OctoMap, so each octree node is one range of codes.
#pragma once

#include <cstdint>

#include "host/core/voxels/voxel_lattice.hpp"

namespace octoskin {

/// 48 bits used.
using MortonCode = std::uint64_t;

/// Moves bit i to bit 3 i, halving the groups that move together at each line.
[[nodiscard]] constexpr MortonCode spread_bits(std::uint16_t value) noexcept {
    MortonCode bits = value;
    bits = (bits | (bits << 16U)) & 0x0000'FF00'00FFULL;
    bits = (bits | (bits << 8U)) & 0x00F0'0F00'F00FULL;
    bits = (bits | (bits << 4U)) & 0x0C30'C30C'30C3ULL;
    bits = (bits | (bits << 2U)) & 0x2492'4924'9249ULL;
    return bits;
}

/// The inverse: bit 3 i to bit i.
[[nodiscard]] constexpr std::uint16_t gather_bits(MortonCode code) noexcept {
    MortonCode bits = code & 0x2492'4924'9249ULL;
    bits = (bits | (bits >> 2U)) & 0x0C30'C30C'30C3ULL;
    bits = (bits | (bits >> 4U)) & 0x00F0'0F00'F00FULL;
    bits = (bits | (bits >> 8U)) & 0x0000'FF00'00FFULL;
    bits = (bits | (bits >> 16U)) & 0xFFFFULL;
    return static_cast<std::uint16_t>(bits);
}

[[nodiscard]] constexpr MortonCode morton_of(VoxelKey key) noexcept {
    return spread_bits(key.x) | (spread_bits(key.y) << 1U) | (spread_bits(key.z) << 2U);
}
[[nodiscard]] constexpr VoxelKey key_of_morton(MortonCode code) noexcept {
    return {gather_bits(code), gather_bits(code >> 1U), gather_bits(code >> 2U)};
}

}  // namespace octoskin
