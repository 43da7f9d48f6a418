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
    /// Takes all rays that end in something; `box` holds them. False, and nothing done, if it has over
    /// `voxels_max` voxels, in whole bricks. O(pixels + voxels of the box / 64); some 0.3 ms for 512 x 424.
    /// Throws std::bad_alloc.
    [[nodiscard]] bool take(const PlacedImage& rays, const KeyBox& box, std::size_t voxels_max) {
        if (!begin(box, voxels_max, 1)) return false;
        mark(rays, 0);
        return true;
    }
    /// The same in parts: after `begin`, if it is true, several threads may each mark one.
    [[nodiscard]] bool begin(const KeyBox& box, std::size_t voxels_max, std::size_t parts);
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
