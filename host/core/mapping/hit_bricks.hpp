// The hits of one image, by brick.
#pragma once

#include <array>
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

/// How much further or less far the rays of an image may end.
struct EndDoubts {
    std::span<const float> depths_m = {};  ///< of each pixel, kLanesMax more may be read; empty: no doubts
    double resolution_m = 0.0;
};

/// Finds the largest hit term of each voxel. Reuses its memory for the next image.
class HitBricks {
  public:
    /// Takes all rays that end on a surface; `box` contains them. False, with nothing done, if the box has
    /// over `voxels_max` voxels.
    ///
    /// If the doubt of an end leads into the next voxel along its ray, the end is uncertain. A voxel with
    /// only such ends, each beside a voxel in which other rays certainly end, has a term of 0. About 0.6 ms
    /// for 512 x 424. Throws std::bad_alloc.
    [[nodiscard]] bool take(const ProjectedImage& rays, const EndDoubts& doubts, const KeyBox& box,
                            const HitModel& model, std::size_t voxels_max);
    [[nodiscard]] BrickHits of(MortonCode brick) const noexcept;

  private:
    /// Of the voxels of a word, by what is beyond the face that is in doubt: `faces[2 * axis]` the voxel
    /// below, `faces[2 * axis + 1]` the one above; `faces[kCertain]`: nothing is in doubt.
    static constexpr std::size_t kCertain = 6;
    using FaceMasks = std::array<std::uint64_t, 8>;

    void take_row(const ProjectedImage& rays, const EndDoubts& doubts, std::size_t first,
                  const HitModel& model);
    void clear(std::size_t words);
    void settle_doubts();
    [[nodiscard]] std::uint64_t beside_certain(std::uint32_t place, std::size_t face) const;
    [[nodiscard]] std::uint64_t certain_in(std::ptrdiff_t place) const;

    BrickBox box_;
    std::vector<std::uint32_t> words_;   ///< where the terms of each of the box's words begin; 0: no hits
    std::vector<std::uint32_t> used_;    ///< the words with hits
    std::vector<float> terms_;           ///< 64 for each word with hits, and as many for no word
    std::vector<std::uint32_t> places_;  ///< the word of each ray of a row
    std::vector<std::uint32_t> bits_;    ///< the voxel in that word
    std::vector<float> row_terms_;
    std::vector<std::uint32_t> faces_;  ///< of FaceMasks, for each ray of a row
    std::vector<FaceMasks> masks_;      ///< by word with hits, in the order of `terms_`
};

}  // namespace octoskin
