// The hits of one image, grouped by brick.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "host/core/bricks/brick.hpp"
#include "host/core/bricks/brick_box.hpp"
#include "host/core/mapping/update_model.hpp"
#include "host/core/traversal/projected_image.hpp"
#include "host/core/voxels/key_box.hpp"

namespace octoskin {

/// The hits of adjacent pixels of a row whose rays end in the same voxel.
struct CellHits {
    std::uint16_t cell = 0;
    float most = 0.0F;  ///< the largest of their terms
};

/// Groups the ends of an image's rays by brick with a counting sort. Reuses its memory for the next image.
class HitBricks {
  public:
    /// Takes all rays that end on a surface; `box` contains them. False, with nothing done, if the box has
    /// over `voxels_max` voxels. O(pixels + bricks of the box). Throws std::bad_alloc.
    [[nodiscard]] bool take(const ProjectedImage& rays, const KeyBox& box, const HitModel& model,
                            std::size_t voxels_max);
    /// The hits in a brick, in the order of pixels.
    [[nodiscard]] std::span<const CellHits> of(MortonCode brick) const noexcept;
    [[nodiscard]] BrickMask mask_of(MortonCode brick) const noexcept;

  private:
    void take_row(const ProjectedImage& rays, std::size_t first, const HitModel& model);
    void sort();

    BrickBox box_;
    std::vector<float> terms_;  ///< one for each ray of a row
    /// A bit for each of those: the next ray ends in another voxel, or has no end.
    std::vector<std::uint64_t> run_ends_;
    std::vector<CellHits> runs_;         ///< capacity for one each pixel; in the order of pixels
    std::vector<std::uint32_t> bricks_;  ///< the brick of each run
    std::size_t count_ = 0;              ///< number of runs
    std::vector<std::uint32_t> ends_;    ///< by brick: end of its hits, and begin of the next brick's
    std::vector<CellHits> sorted_;
};

}  // namespace octoskin
