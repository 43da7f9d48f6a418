// A box of voxels with one value each: the storage of ground truths and sampled maps.
#pragma once

#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/core/mapping/fused_map.hpp"

namespace octoskin::evaluation {

/// All voxels from `min` to `max`, both included, numbered 0..size()-1 with x running fastest.
struct KeyBox {
    VoxelKey min;
    VoxelKey max;

    [[nodiscard]] constexpr std::array<std::size_t, 3> shape() const noexcept {
        return {extent(min.x, max.x), extent(min.y, max.y), extent(min.z, max.z)};
    }
    [[nodiscard]] constexpr std::size_t size() const noexcept {
        const auto [nx, ny, nz] = shape();
        return nx * ny * nz;
    }
    [[nodiscard]] constexpr bool contains(VoxelKey key) const noexcept {
        return min.x <= key.x && key.x <= max.x && min.y <= key.y && key.y <= max.y && min.z <= key.z &&
               key.z <= max.z;
    }
    /// Only for a key that the box contains.
    [[nodiscard]] constexpr std::size_t index_of(VoxelKey key) const noexcept {
        const auto [nx, ny, nz] = shape();
        return static_cast<std::size_t>(key.x - min.x) +
               nx * (static_cast<std::size_t>(key.y - min.y) + ny * static_cast<std::size_t>(key.z - min.z));
    }
    /// The inverse of `index_of`.
    [[nodiscard]] constexpr VoxelKey key_at(std::size_t index) const noexcept {
        const auto [nx, ny, nz] = shape();
        return {static_cast<std::uint16_t>(min.x + index % nx),
                static_cast<std::uint16_t>(min.y + index / nx % ny),
                static_cast<std::uint16_t>(min.z + index / (nx * ny))};
    }
    /// The box grown by `voxels` on every side, clipped to the range of keys.
    [[nodiscard]] KeyBox padded(std::uint16_t voxels) const noexcept;

    friend constexpr bool operator==(const KeyBox&, const KeyBox&) = default;

  private:
    static constexpr std::size_t extent(std::uint16_t low, std::uint16_t high) noexcept {
        return high < low ? 0 : static_cast<std::size_t>(high - low) + 1;
    }
};

/// One `T` for every voxel of a box.
template <class T>
class VoxelGrid {
  public:
    explicit VoxelGrid(const KeyBox& box, T value = T{}) : box_(box), values_(box.size(), value) {}

    [[nodiscard]] const KeyBox& box() const noexcept { return box_; }
    [[nodiscard]] std::size_t size() const noexcept { return values_.size(); }
    [[nodiscard]] T& operator[](std::size_t index) { return values_[index]; }
    [[nodiscard]] const T& operator[](std::size_t index) const { return values_[index]; }
    [[nodiscard]] T& at(VoxelKey key) {
        assert(box_.contains(key));
        return values_[box_.index_of(key)];
    }
    [[nodiscard]] const T& at(VoxelKey key) const {
        assert(box_.contains(key));
        return values_[box_.index_of(key)];
    }

  private:
    KeyBox box_;
    std::vector<T> values_;
};

/// A mask over voxels (char, since std::vector<bool> hands out no references).
using VoxelMask = VoxelGrid<char>;

/// The mask grown by `voxels` in each of the 26 directions (Chebyshev distance). O(size), independent of
/// `voxels`.
[[nodiscard]] VoxelMask dilated(const VoxelMask& mask, std::uint16_t voxels);

}  // namespace octoskin::evaluation
