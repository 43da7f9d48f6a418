// Counts, for each voxel of a box, the rays that passed it and the hit terms that ended in it: input of
// `robust`.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/core/voxels/key_box.hpp"
#include "host/core/voxels/ray_walk.hpp"
#include "host/core/voxels/voxel_lattice.hpp"

namespace octoskin {

/// Everything that the rays of one image state about one voxel.
struct VoxelTally {
    std::uint32_t passed = 0;
    std::uint32_t hits = 0;
    double hit_sum = 0.0;
};

/// A dense grid over a box of voxels, one voxel wider on every side, because rounding may lead a ray there
/// (see `Ray::steps_max`). Reuses its memory for the next image.
class TallyGrid {
  public:
    /// Covers `box` with all counts 0. False, with nothing done, if the grid would need over `voxels_max`
    /// voxels. Every use must end with drain().
    [[nodiscard]] bool span(const KeyBox& box, std::size_t voxels_max);

    /// How walk_ray() numbers the voxels of this grid; the ray must lie in the box.
    [[nodiscard]] VoxelIndexing indexing_of(const Ray& ray) const noexcept {
        return {.first = index_of(ray.first), .last = index_of(ray.last), .stride = stride_};
    }
    [[nodiscard]] std::ptrdiff_t index_of(VoxelKey key) const noexcept {
        return (key.x - corner_[0]) * stride_[0] + (key.y - corner_[1]) * stride_[1] +
               (key.z - corner_[2]) * stride_[2];
    }

    void add_pass(std::ptrdiff_t index) noexcept { ++marks_[static_cast<std::size_t>(index)]; }
    void add_hit(std::ptrdiff_t index, float term);

    /// Calls take(key, tally) for each voxel passed or hit, in ascending (z, y, x), and empties the grid.
    /// Voxels outside the octree are omitted.
    template <class Take>
    void drain(Take&& take);

  private:
    /// Top bit of a mark: the voxel was hit, and `hit_slots_` has the index of its hits. Other bits: number
    /// of rays that passed; an image has far fewer than 2^31 pixels.
    static constexpr std::uint32_t kIsHit = 1U << 31U;

    template <class Take>
    void drain_row(std::size_t index, int y_key, int z_key, Take& take);

    std::array<int, 3> corner_{};  ///< key of the voxel at index 0; may be -1
    std::array<int, 3> size_{};
    std::array<std::ptrdiff_t, 3> stride_{};
    std::vector<std::uint32_t> marks_;      ///< all 0 between two images
    std::vector<std::uint32_t> hit_slots_;  ///< index into hits_; valid only if the mark has kIsHit
    std::vector<VoxelTally> hits_;
};

template <class Take>
void TallyGrid::drain(Take&& take) {
    for (int z = 0; z < size_[2]; ++z) {
        for (int y = 0; y < size_[1]; ++y) {
            const std::ptrdiff_t row = y * stride_[1] + z * stride_[2];
            drain_row(static_cast<std::size_t>(row), corner_[1] + y, corner_[2] + z, take);
        }
    }
    hits_.clear();
}

template <class Take>
void TallyGrid::drain_row(std::size_t index, int y_key, int z_key, Take& take) {
    const auto is_key = [](int value) { return value >= 0 && value < kVoxelsPerAxis; };
    for (int x_key = corner_[0]; x_key < corner_[0] + size_[0]; ++x_key, ++index) {
        const std::uint32_t mark = marks_[index];
        if (mark == 0) continue;
        marks_[index] = 0;
        if (!is_key(x_key) || !is_key(y_key) || !is_key(z_key)) continue;
        VoxelTally tally;
        if ((mark & kIsHit) != 0) tally = hits_[hit_slots_[index]];
        tally.passed = mark & ~kIsHit;
        take(VoxelKey{static_cast<std::uint16_t>(x_key), static_cast<std::uint16_t>(y_key),
                      static_cast<std::uint16_t>(z_key)},
             tally);
    }
}

}  // namespace octoskin
