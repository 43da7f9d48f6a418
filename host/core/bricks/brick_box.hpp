// Brick coordinates along each axis, and boxes of bricks.
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>

#include "host/core/bricks/brick.hpp"
#include "host/core/voxels/key_box.hpp"

namespace octoskin {

enum class Axis : std::uint8_t { x, y, z };
inline constexpr std::size_t kAxisCount = 3;

/// Coordinates of a brick: its voxels' keys along x, y and z, divided by kBrickEdge.
struct BrickPlace {
    static constexpr int kPerAxis = kVoxelsPerAxis / kBrickEdge;

    std::array<int, kAxisCount> at{};

    [[nodiscard]] static constexpr BrickPlace of(VoxelKey key) noexcept {
        return {{key.x / kBrickEdge, key.y / kBrickEdge, key.z / kBrickEdge}};
    }
    [[nodiscard]] constexpr VoxelCube cube() const noexcept {
        const auto along = [this](std::size_t axis) {
            return static_cast<std::uint16_t>(at[axis] * kBrickEdge);
        };
        return {{along(0), along(1), along(2)}, kBrickHeight};
    }
    [[nodiscard]] constexpr BrickPlace moved(Axis axis, int bricks) const noexcept {
        BrickPlace place = *this;
        place.at[static_cast<std::size_t>(axis)] += bricks;
        return place;
    }
};

/// The bricks from `lowest` to `highest` along each axis, both included.
struct BrickBox {
    BrickPlace lowest;
    BrickPlace highest;

    [[nodiscard]] static constexpr BrickBox of(const KeyBox& voxels) noexcept {
        return {BrickPlace::of(voxels.lowest), BrickPlace::of(voxels.highest)};
    }
    [[nodiscard]] constexpr bool holds(const BrickPlace& place) const noexcept {
        bool is_inside = true;
        for (std::size_t axis = 0; axis < kAxisCount; ++axis)
            is_inside &= place.at[axis] >= lowest.at[axis] && place.at[axis] <= highest.at[axis];
        return is_inside;
    }
    /// The box with `bricks` more bricks on both sides of an axis, limited by the octree.
    [[nodiscard]] constexpr BrickBox wider(Axis axis, int bricks) const noexcept {
        BrickBox box = *this;
        const auto along = static_cast<std::size_t>(axis);
        box.lowest.at[along] = std::max(lowest.at[along] - bricks, 0);
        box.highest.at[along] = std::min(highest.at[along] + bricks, BrickPlace::kPerAxis - 1);
        return box;
    }
    [[nodiscard]] constexpr std::size_t edge(std::size_t axis) const noexcept {
        return static_cast<std::size_t>(highest.at[axis] - lowest.at[axis] + 1);
    }
    [[nodiscard]] constexpr std::size_t bricks() const noexcept { return edge(0) * edge(1) * edge(2); }
    /// Linear index of a brick in the box, starting with 0; x varies fastest, then y.
    [[nodiscard]] constexpr std::size_t index(const BrickPlace& place) const noexcept {
        assert(holds(place));
        const auto from = [&](std::size_t axis) {
            return static_cast<std::size_t>(place.at[axis] - lowest.at[axis]);
        };
        return from(0) + edge(0) * (from(1) + edge(1) * from(2));
    }
};

}  // namespace octoskin
