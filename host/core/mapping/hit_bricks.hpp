// The hits of one image, by brick.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "host/core/bricks/brick.hpp"
#include "host/core/mapping/update_model.hpp"
#include "host/core/traversal/placed_image.hpp"
#include "host/core/voxels/key_box.hpp"
#include "host/core/voxels/voxel_lattice.hpp"

namespace octoskin {

/// Of neighbouring pixels of a row, whose rays end in one voxel.
struct CellHits {
    std::uint16_t cell = 0;
    std::uint16_t rays = 0;
    float sum = 0.0F;  ///< of their terms
    float most = 0.0F;
};

/// Sorts the ends of an image's rays by counting. Its memory stays for the next image.
class HitBricks {
  public:
    /// Takes all rays that end in something; `box` holds them. False, and nothing done, if it has over
    /// `voxels_max` voxels. O(pixels + bricks of the box). Throws std::bad_alloc.
    [[nodiscard]] bool take(const PlacedImage& rays, const KeyBox& box, const HitModel& model,
                            std::size_t voxels_max);
    /// The same in steps: after `begin`, if it is true, several threads may each `find` in some of `kBands`
    /// bands of rows; once all are, `sort`.
    static constexpr std::size_t kBands = 4;
    [[nodiscard]] bool begin(const KeyBox& box, std::size_t voxels_max);
    void find(const PlacedImage& rays, const HitModel& model, std::size_t band);
    void sort();
    /// Of a brick: in the order of pixels.
    [[nodiscard]] std::span<const CellHits> of(MortonCode brick) const noexcept;
    [[nodiscard]] BrickMask mask_of(MortonCode brick) const noexcept;

  private:
    [[nodiscard]] std::size_t index_of(VoxelKey key) const noexcept {
        const auto along = [](std::uint16_t from, std::uint16_t to) {
            return static_cast<std::size_t>((to >> kBrickHeight) - (from >> kBrickHeight));
        };
        return along(box_.lowest.x, key.x) +
               bricks_x_ * (along(box_.lowest.y, key.y) + bricks_y_ * along(box_.lowest.z, key.z));
    }

    struct Band {
        std::vector<float> terms;  ///< of a row's rays
        /// A bit for each of those: the next one ends in another voxel, or in nothing.
        std::vector<std::uint64_t> run_ends;
        std::vector<CellHits> runs;         ///< room for one a pixel; in the order of pixels
        std::vector<std::uint32_t> bricks;  ///< of each of those
        std::size_t count = 0;              ///< of runs
    };
    void take_row(const PlacedImage& rays, std::size_t first, const HitModel& model, Band& band) const;
    /// Of neighbouring rays that end in one voxel, from their terms.
    [[nodiscard]] static CellHits run_of(VoxelKey key, std::span<const float> terms);

    KeyBox box_;
    std::size_t bricks_x_ = 0;
    std::size_t bricks_y_ = 0;
    std::array<Band, kBands> bands_;
    std::vector<std::uint32_t> ends_;  ///< by brick: where its hits end, and the next one's begin
    std::vector<CellHits> sorted_;
};

}  // namespace octoskin
