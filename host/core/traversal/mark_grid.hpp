// One byte for each voxel of a box: passed by a ray, hit by one, or neither.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>

#include "host/core/voxels/voxel_lattice.hpp"

namespace octoskin {

/// Rows run along x. The box begins and ends on a multiple of eight voxels along each axis, so that eight
/// marks of a row are one aligned word and a brick of 8 x 8 x 8 voxels is wholly inside or outside; and it is
/// at least a voxel wider on every side than what was asked for, which is where rounding may lead a ray.
class MarkGrid {
  public:
    static constexpr std::uint8_t kPassed = 1;
    static constexpr std::uint8_t kHit = 2;
    static constexpr int kBrick = 8;

    /// Spans the voxels from `lowest` to `highest`, both inside, without a mark; false, and nothing done, if
    /// that takes over `voxels_max`. The memory stays, and what is never marked is never touched. Throws
    /// std::bad_alloc.
    [[nodiscard]] bool span(VoxelKey lowest, VoxelKey highest, std::size_t voxels_max);
    /// Gives the memory back, marks and all.
    void forget() noexcept;

    [[nodiscard]] std::ptrdiff_t index_of(VoxelKey key) const noexcept {
        return index_of(key.x, key.y, key.z);
    }
    [[nodiscard]] std::ptrdiff_t index_of(int x, int y, int z) const noexcept {
        return (x - corner_[0]) + (y - corner_[1]) * stride_[1] + (z - corner_[2]) * stride_[2];
    }
    /// A place for marks that count for nothing.
    [[nodiscard]] std::ptrdiff_t nowhere() const noexcept { return static_cast<std::ptrdiff_t>(voxels_); }

    [[nodiscard]] const std::array<int, 3>& corner() const noexcept { return corner_; }
    [[nodiscard]] const std::array<int, 3>& size() const noexcept { return size_; }
    [[nodiscard]] const std::array<std::ptrdiff_t, 3>& stride() const noexcept { return stride_; }
    [[nodiscard]] std::uint8_t* marks() noexcept { return marks_.get(); }

    /// Calls take(key, mark) for each marked voxel that has a key, in ascending (z, y, x), and leaves no
    /// mark.
    template <class Take>
    void drain(Take&& take);

  private:
    struct Free {
        void operator()(std::uint8_t* marks) const noexcept { std::free(marks); }
    };

    std::array<int, 3> corner_{};  ///< key of the voxel at index 0; may be -8
    std::array<int, 3> size_{};
    std::array<std::ptrdiff_t, 3> stride_{};
    std::size_t voxels_ = 0;
    std::size_t capacity_ = 0;
    std::unique_ptr<std::uint8_t[], Free> marks_;
};

template <class Take>
void MarkGrid::drain(Take&& take) {
    const auto is_key = [](int value) { return value >= 0 && value < kVoxelsPerAxis; };
    for (int z = corner_[2]; z < corner_[2] + size_[2]; ++z) {
        for (int y = corner_[1]; y < corner_[1] + size_[1]; ++y) {
            std::uint8_t* const row = marks_.get() + index_of(corner_[0], y, z);
            if (!is_key(y) || !is_key(z)) {
                std::fill_n(row, size_[0], std::uint8_t{0});
                continue;
            }
            for (int i = 0; i < size_[0]; i += kBrick) {
                std::uint64_t eight = 0;
                std::memcpy(&eight, row + i, sizeof(eight));
                if (eight == 0) continue;
                for (int j = i; j < i + kBrick; ++j) {
                    const int x = corner_[0] + j;
                    if (row[j] == 0 || !is_key(x)) continue;
                    take(VoxelKey{static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y),
                                  static_cast<std::uint16_t>(z)},
                         row[j]);
                }
                std::memset(row + i, 0, kBrick);
            }
        }
    }
    marks_[voxels_] = 0;  // nowhere is somewhere in the next grid
}

}  // namespace octoskin
