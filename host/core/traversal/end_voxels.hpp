// The set of voxels in which the rays of an image end.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/core/bricks/brick.hpp"
#include "host/core/bricks/brick_box.hpp"
#include "host/core/traversal/projected_image.hpp"
#include "host/core/voxels/key_box.hpp"

namespace octoskin {

/// One bit for each voxel of a box, per part. Keeps its memory for the next image.
class EndVoxels {
  public:
    /// Starts an empty set; `box` contains the ends of all rays to come. Returns false and does nothing if
    /// the box has over `voxels_max` voxels, in whole bricks. O(voxels of the box / 64). Throws
    /// std::bad_alloc.
    [[nodiscard]] bool begin(const KeyBox& box, std::size_t voxels_max, std::size_t parts);
    /// Adds the rays of one part of the image that end at a surface. Several threads may each take a part;
    /// about 0.2 ms for 512 x 424. Throws std::bad_alloc.
    void mark(const ProjectedImage& rays, std::size_t part);

    [[nodiscard]] BrickMask of(MortonCode brick) const noexcept;

  private:
    /// The data of one part's rows.
    struct Part {
        std::vector<std::uint64_t> words;   ///< by brick, as in a BrickMask; one last word for no voxel
        std::vector<std::uint32_t> places;  ///< word of each end of a row
        std::vector<std::uint32_t> bits;    ///< bit of each end of a row
    };

    BrickBox box_;
    std::vector<Part> parts_;
};

}  // namespace octoskin
