// Pieces of an image's rays, walked many at once.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "host/core/traversal/mark_grid.hpp"
#include "host/core/traversal/placed_image.hpp"
#include "host/core/voxels/voxel_lattice.hpp"

namespace octoskin {

/// The part of a pixel's ray between two depths along the optical axis, metres.
struct RayPiece {
    std::uint32_t pixel = 0;
    float from_m = 0.0F;  ///< 0: from the ray's origin on
    float to_m = 0.0F;    ///< infinity: to its end
};

/// Marks as passed what OctoMap's computeRayKeys visits of each piece's ray between its two depths, and
/// perhaps more of what it visits of that ray. A whole ray (from 0 to infinity) is walked in OctoMap's
/// arithmetic, rounding error by rounding error. A walk that begins later has other rounding errors: of two
/// faces that are crossed at almost the same distance it could not tell the first, so its pixel goes to
/// `undecided`, and what was marked of it is what it passes in truth. The grid spans every ray. About 1 ns a
/// voxel.
void walk_pieces(const PlacedImage& image, const VoxelLattice& lattice, std::span<const RayPiece> pieces,
                 MarkGrid& grid, std::vector<std::uint32_t>& undecided);

}  // namespace octoskin
