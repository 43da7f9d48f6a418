// The hits of one image, by brick.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "host/core/bricks/brick.hpp"
#include "host/core/bricks/brick_box.hpp"
#include "host/core/mapping/update_model.hpp"
#include "host/core/traversal/placed_image.hpp"
#include "host/core/voxels/key_box.hpp"

namespace octoskin {

/// Of neighbouring pixels of a row, whose rays end in one voxel.
struct CellHits {
    std::uint16_t cell = 0;
    float most = 0.0F;  ///< of their terms
};

/// Sorts the ends of an image's rays by counting. Its memory stays for the next image.
class HitBricks {
  public:
    /// Takes all rays that end in something; `box` holds them. False, and nothing done, if it has over
    /// `voxels_max` voxels. O(pixels + bricks of the box). Throws std::bad_alloc.
    [[nodiscard]] bool take(const PlacedImage& rays, const KeyBox& box, const HitModel& model,
                            std::size_t voxels_max);
    /// Of a brick: in the order of pixels.
    [[nodiscard]] std::span<const CellHits> of(MortonCode brick) const noexcept;
    [[nodiscard]] BrickMask mask_of(MortonCode brick) const noexcept;

  private:
    void take_row(const PlacedImage& rays, std::size_t first, const HitModel& model);
    void sort();

    BrickBox box_;
    std::vector<float> terms_;  ///< of a row's rays
    /// A bit for each of those: the next one ends in another voxel, or in nothing.
    std::vector<std::uint64_t> run_ends_;
    std::vector<CellHits> runs_;         ///< room for one a pixel; in the order of pixels
    std::vector<std::uint32_t> bricks_;  ///< of each of those
    std::size_t count_ = 0;              ///< of runs
    std::vector<std::uint32_t> ends_;    ///< by brick: where its hits end, and the next one's begin
    std::vector<CellHits> sorted_;
};

}  // namespace octoskin
