// Things of bricks in a box of space, found by where a brick is.
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "host/core/bricks/brick.hpp"
#include "host/core/voxels/key_box.hpp"

namespace octoskin {

enum class Axis : std::uint8_t { x, y, z };
inline constexpr std::size_t kAxisCount = 3;

/// A brick: its voxels' keys along x, y and z, divided by kBrickEdge.
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

/// Bricks from the lowest to the highest along each axis, both inside.
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
    /// So many bricks more on both sides, as far as the octree goes.
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
};

/// 8 bytes for each brick of the box, and what is there.
template <class Thing>
class BrickGrid {
  public:
    explicit BrickGrid(const BrickBox& box) : box_(box), things_(box.bricks()) {}

    [[nodiscard]] const BrickBox& box() const noexcept { return box_; }
    /// Of a brick of the box.
    [[nodiscard]] std::size_t index(const BrickPlace& place) const noexcept {
        assert(box_.holds(place));
        const auto from = [&](std::size_t axis) {
            return static_cast<std::size_t>(place.at[axis] - box_.lowest.at[axis]);
        };
        return from(0) + box_.edge(0) * (from(1) + box_.edge(1) * from(2));
    }
    [[nodiscard]] BrickPlace place(std::size_t index) const noexcept {
        const auto from = [&](std::size_t axis, std::size_t steps) {
            return box_.lowest.at[axis] + static_cast<int>(steps % box_.edge(axis));
        };
        return {
            {from(0, index), from(1, index / box_.edge(0)), from(2, index / (box_.edge(0) * box_.edge(1)))}};
    }
    /// Null: there is none, or the brick is not of the box.
    [[nodiscard]] const Thing* find(const BrickPlace& place) const noexcept {
        return box_.holds(place) ? things_[index(place)].get() : nullptr;
    }
    [[nodiscard]] const Thing* operator[](std::size_t index) const noexcept { return things_[index].get(); }
    /// What is there or, if nothing is, a copy of `otherwise`, which is there from then on.
    [[nodiscard]] Thing& open(std::size_t index, const Thing& otherwise) {
        if (!things_[index]) {
            things_[index] = std::make_unique<Thing>(otherwise);
            ++count_;
        }
        return *things_[index];
    }
    void take_away(std::size_t index) noexcept {
        count_ -= things_[index] ? 1U : 0U;
        things_[index].reset();
    }
    [[nodiscard]] std::size_t memory_bytes() const noexcept {
        constexpr std::size_t kOfHeap = 16;  // what an allocation takes beside, about
        return things_.size() * sizeof(things_[0]) + count_ * (sizeof(Thing) + kOfHeap);
    }

  private:
    BrickBox box_;
    std::vector<std::unique_ptr<Thing>> things_;
    std::size_t count_ = 0;
};

}  // namespace octoskin
