// The hits of one image, by voxel.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace octoskin {

/// The largest term of each voxel that was hit, by the voxel's index in a grid of at most 2^32 - 1: a hash
/// table with open addressing. Its memory stays for the next image.
class HitTable {
  public:
    /// Forgets all. Throws std::bad_alloc.
    void begin(std::size_t hits_max);
    /// Pixel after pixel: neighbours mostly hit the same voxel.
    void add(std::ptrdiff_t voxel, float term) noexcept;
    /// After the last one was added. Throws std::bad_alloc.
    void finish();
    /// Of a voxel that was added (asserted). Once finished.
    [[nodiscard]] float largest(std::ptrdiff_t voxel) const noexcept;

  private:
    struct Hit {
        std::uint32_t voxel = kNone;
        float term = 0.0F;
    };
    static constexpr std::uint32_t kNone = 0xFFFF'FFFF;
    /// Where the voxel's slot is, or the free one that is to be its own.
    [[nodiscard]] std::size_t slot_of(std::uint32_t voxel) const noexcept;

    std::vector<Hit> runs_;   ///< of pixels
    std::vector<Hit> slots_;  ///< a power of two, at most half of them taken
};

}  // namespace octoskin
