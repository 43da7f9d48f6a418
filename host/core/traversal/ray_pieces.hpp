// Ray segments: pieces of an image's rays, many of which are walked at a time.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "host/core/traversal/projected_image.hpp"
#include "host/core/traversal/visited_grid.hpp"
#include "host/core/voxels/voxel_lattice.hpp"

namespace octoskin {

/// The part of a pixel's ray between two depths along the optical axis, metres.
struct RayPiece {
    std::uint32_t pixel = 0;
    float from_m = 0.0F;  ///< 0: from the ray's origin on
    float to_m = 0.0F;    ///< infinity: to its end
};

/// Marks as passed the voxels that OctoMap's computeRayKeys visits of each piece's ray between its two
/// depths, and possibly more of that ray's voxels. A whole ray (from 0 to infinity) is walked in OctoMap's
/// arithmetic, with the same rounding errors. A walk that begins later has other rounding errors: if two
/// faces are crossed at almost the same distance, their order is uncertain. The pixel is then added to
/// `undecided`; the voxels marked for it so far are correct. The grid spans all rays. About 1 ns per voxel.
void walk_pieces(const ProjectedImage& image, const VoxelLattice& lattice, std::span<const RayPiece> pieces,
                 VisitedGrid& grid, std::vector<std::uint32_t>& undecided);

}  // namespace octoskin
