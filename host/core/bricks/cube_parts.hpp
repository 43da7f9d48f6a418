// Divides a cube into 64 parts, four along each edge, in Morton order: the places of a node, or the voxels of
// a brick word.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "host/core/voxels/key_box.hpp"

namespace octoskin {

/// Sets of parts by their position along an axis (0 to 2): the second and fourth, and the upper two.
inline constexpr std::array<std::uint64_t, 3> kOddParts = {0xAAAA'AAAA'AAAA'AAAAU, 0xCCCC'CCCC'CCCC'CCCCU,
                                                           0xF0F0'F0F0'F0F0'F0F0U};
inline constexpr std::array<std::uint64_t, 3> kUpperParts = {0xFF00'FF00'FF00'FF00U, 0xFFFF'0000'FFFF'0000U,
                                                             0xFFFF'FFFF'0000'0000U};

/// One part of a cube of height 2 or more.
[[nodiscard]] constexpr VoxelCube part_of(const VoxelCube& cube, std::size_t part) noexcept {
    const unsigned height = cube.height - 2;
    // The position along an axis, 0 to 3: its low bit is in the lower three bits of `part`, its high bit in
    // the upper three.
    const auto along = [&](std::uint16_t lowest, unsigned axis) {
        const std::size_t place = ((part >> axis) & 1U) | ((part >> (axis + 2U)) & 2U);
        return static_cast<std::uint16_t>(lowest + (place << height));
    };
    return {{along(cube.lowest.x, 0), along(cube.lowest.y, 1), along(cube.lowest.z, 2)}, height};
}

/// The parts of a cube of height 2 or more that have a voxel in common with the box: bit i is part i.
[[nodiscard]] constexpr std::uint64_t parts_in(const VoxelCube& cube, const KeyBox& box) noexcept {
    const unsigned height = cube.height - 2;
    // `odd` and `upper`: parts whose position along an axis has the low and the high bit set.
    const auto along = [height](int lowest, int box_lowest, int box_highest, std::uint64_t odd,
                                std::uint64_t upper) {
        const int first = std::max((box_lowest - lowest) >> height, 0);
        const int last = std::min((box_highest - lowest) >> height, 3);
        std::uint64_t parts = 0;
        for (int place = first; place <= last; ++place) {
            parts |= ((place & 1) != 0 ? odd : ~odd) & ((place & 2) != 0 ? upper : ~upper);
        }
        return parts;
    };
    return along(cube.lowest.x, box.lowest.x, box.highest.x, kOddParts[0], kUpperParts[0]) &
           along(cube.lowest.y, box.lowest.y, box.highest.y, kOddParts[1], kUpperParts[1]) &
           along(cube.lowest.z, box.lowest.z, box.highest.z, kOddParts[2], kUpperParts[2]);
}

/// The parts next to `parts` in the positive direction of the axis.
[[nodiscard]] constexpr std::uint64_t parts_after(std::uint64_t parts, std::size_t axis) noexcept {
    const std::uint64_t odd = kOddParts[axis];
    return (parts & ~odd) << (1U << axis) | (parts & odd & ~kUpperParts[axis]) << (7U << axis);
}
/// The parts next to `parts` in the negative direction of the axis.
[[nodiscard]] constexpr std::uint64_t parts_before(std::uint64_t parts, std::size_t axis) noexcept {
    const std::uint64_t odd = kOddParts[axis];
    return (parts & odd) >> (1U << axis) | (parts & ~odd & kUpperParts[axis]) >> (7U << axis);
}

}  // namespace octoskin
