// The hits of one image, by brick.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/core/bricks/brick.hpp"
#include "host/core/bricks/brick_box.hpp"
#include "host/core/mapping/update_model.hpp"
#include "host/core/traversal/projected_image.hpp"
#include "host/core/voxels/key_box.hpp"

namespace octoskin {

/// The voxels of one brick in which rays end at a surface. It is valid until HitBricks takes the next image.
class BrickHits {
  public:
    [[nodiscard]] const BrickMask& mask() const noexcept { return mask_; }
    /// The largest term of the rays that end in a voxel of the mask.
    [[nodiscard]] float largest(std::size_t cell) const noexcept { return words_[cell / 64][cell % 64]; }

  private:
    friend class HitBricks;
    BrickMask mask_{};
    std::array<const float*, kBrickVoxels / 64> words_{};
};

/// Finds the largest hit term of each voxel. Reuses its memory for the next image.
class HitBricks {
  public:
    /// Takes all rays that end on a surface; `box` contains them. False, with nothing done, if the box has
    /// over `voxels_max` voxels. About 0.4 ms for 512 x 424. Throws std::bad_alloc.
    [[nodiscard]] bool take(const ProjectedImage& rays, const KeyBox& box, const HitModel& model,
                            std::size_t voxels_max);
    [[nodiscard]] BrickHits of(MortonCode brick) const noexcept;

  private:
    void take_row(const ProjectedImage& rays, std::size_t first, const HitModel& model);
    void clear(std::size_t words);

    BrickBox box_;
    std::vector<std::uint32_t> words_;   ///< where the terms of each of the box's words begin; 0: no hits
    std::vector<std::uint32_t> used_;    ///< the words with hits
    std::vector<float> terms_;           ///< 64 for each word with hits, and as many for no word
    std::vector<std::uint32_t> places_;  ///< the word of each ray of a row
    std::vector<std::uint32_t> bits_;    ///< the voxel in that word
    std::vector<float> row_terms_;
};

}  // namespace octoskin
