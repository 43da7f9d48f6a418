// The visited grid: one byte for each voxel of a box, passed by a ray or not.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>

#include "host/core/bricks/brick.hpp"
#include "host/core/bricks/brick_walk.hpp"
#include "host/core/voxels/key_box.hpp"
#include "host/core/voxels/voxel_lattice.hpp"

namespace octoskin {

/// Rows run along x. The box begins and ends at a multiple of eight voxels along each axis: eight bytes of a
/// row are then one aligned word, and a brick of 8 x 8 x 8 voxels is completely inside or outside. The box is
/// at least one voxel wider on each side than requested, because rounding may lead a ray there.
class VisitedGrid {
  public:
    static constexpr std::uint8_t kPassed = 1;
    static constexpr int kBrick = kBrickEdge;

    /// Spans the voxels from `lowest` to `highest`, both included, without marks. Returns false and does
    /// nothing if this needs over `voxels_max`. Keeps the memory, and does not touch bytes that are never
    /// marked. Throws std::bad_alloc.
    [[nodiscard]] bool span(VoxelKey lowest, VoxelKey highest, std::size_t voxels_max);
    /// Releases the memory and all marks.
    void forget() noexcept;

    [[nodiscard]] std::ptrdiff_t index_of(VoxelKey key) const noexcept {
        return index_of(key.x, key.y, key.z);
    }
    [[nodiscard]] std::ptrdiff_t index_of(int x, int y, int z) const noexcept {
        return (x - corner_[0]) + (y - corner_[1]) * stride_[1] + (z - corner_[2]) * stride_[2];
    }
    /// Index for marks without effect.
    [[nodiscard]] std::ptrdiff_t nowhere() const noexcept { return static_cast<std::ptrdiff_t>(voxels_); }

    [[nodiscard]] const std::array<int, 3>& corner() const noexcept { return corner_; }
    [[nodiscard]] const std::array<int, 3>& size() const noexcept { return size_; }
    [[nodiscard]] const std::array<std::ptrdiff_t, 3>& stride() const noexcept { return stride_; }
    [[nodiscard]] std::uint8_t* marks() noexcept { return marks_.get(); }

    /// Calls take(brick, passed) for each brick of the box, marked or not, in Morton order, and clears the
    /// grid. `brick`: the code of its first voxel. Voxels without a key are left out.
    template <class Take>
    void drain(Take&& take);

  private:
    /// Returns the marked voxels of a brick and clears them.
    [[nodiscard]] BrickMask take_brick(VoxelKey lowest) noexcept;
    /// Clears the marks outside the octree, where rounding led rays and there are no keys. `box`: all voxels
    /// with a key.
    void clear_beyond_keys(const KeyBox& box) noexcept;

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
void VisitedGrid::drain(Take&& take) {
    const auto key = [](int value) {
        return static_cast<std::uint16_t>(std::clamp(value, 0, kVoxelsPerAxis - 1));
    };
    const KeyBox box{
        {key(corner_[0]), key(corner_[1]), key(corner_[2])},
        {key(corner_[0] + size_[0] - 1), key(corner_[1] + size_[1] - 1), key(corner_[2] + size_[2] - 1)}};
    walk_bricks(
        box, [](const VoxelCube&) { return CubeCoverage::some; },
        [&](MortonCode brick, bool) { take(brick, take_brick(key_of_morton(brick))); });
    clear_beyond_keys(box);
    marks_[voxels_] = 0;  // this index is a voxel in the next grid
}

}  // namespace octoskin
