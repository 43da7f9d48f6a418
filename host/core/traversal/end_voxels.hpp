// The voxels in which the rays of an image end.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/core/bricks/brick.hpp"
#include "host/core/bricks/brick_box.hpp"
#include "host/core/traversal/placed_image.hpp"
#include "host/core/voxels/key_box.hpp"

namespace octoskin {

/// A bit for each voxel of a box and part. Its memory stays for the next image.
class EndVoxels {
  public:
    /// Of no ray yet; `box` holds the ends of all that are to come. False, and nothing done, if it has over
    /// `voxels_max` voxels, in whole bricks. O(voxels of the box / 64). Throws std::bad_alloc.
    [[nodiscard]] bool begin(const KeyBox& box, std::size_t voxels_max, std::size_t parts);
    /// Takes the rays of one part of the image that end in something. Several threads may each take one;
    /// some 0.2 ms for 512 x 424. Throws std::bad_alloc.
    void mark(const PlacedImage& rays, std::size_t part);

    [[nodiscard]] BrickMask of(MortonCode brick) const noexcept;

  private:
    /// Of one part's rows.
    struct Part {
        std::vector<std::uint64_t> words;   ///< by brick, as in a BrickMask; a last one for no voxel
        std::vector<std::uint32_t> places;  ///< of a row's ends: a word each,
        std::vector<std::uint32_t> bits;    ///< and a bit of it
    };

    BrickBox box_;
    std::vector<Part> parts_;
};

}  // namespace octoskin
