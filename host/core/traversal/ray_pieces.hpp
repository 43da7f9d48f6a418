// Ray segments: pieces of an image's rays, many of which are walked at a time.
#pragma once

#include <array>
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

/// Values of all rays of the image along one axis. Whole numbers are stored exactly, as doubles.
struct WalkAxis {
    const float* end = nullptr;  ///< by pixel
    float origin = 0.0F;
    double floored_origin = 0.0;  ///< of the voxel that contains it: key less kOriginKey
    double half_edge_m = 0.0;     ///< in single precision, as in OctoMap
    double stride = 0.0;          ///< increment of the index per voxel
};

struct Walk {
    std::array<WalkAxis, 3> axes;
    double resolution_m = 0.0;
    double voxels_per_m = 0.0;
    double first = 0.0;    ///< index of the voxel that contains the origin
    double error_m = 0.0;  ///< upper bound of the error of distances, for any order of additions
    const float* reach_m = nullptr;
};

/// The caller's numbering of voxels, in whole numbers below 2^51: the number of the voxel that contains the
/// origin, and the increment per voxel along each axis.
struct VoxelNumbers {
    double first = 0.0;
    std::array<double, 3> strides{};
};

/// For all rays of an image from place_image(). `faces_max`: more than any ray crosses.
[[nodiscard]] Walk walk_of(const ProjectedImage& image, const VoxelLattice& lattice,
                           const VoxelNumbers& numbers, double faces_max);

/// Marks as passed the voxels that OctoMap's computeRayKeys visits of each piece's ray between its two
/// depths, and possibly more of that ray's voxels. A whole ray (from 0 to infinity) is walked in OctoMap's
/// arithmetic, with the same rounding errors. A walk that begins later has other rounding errors: if two
/// faces are crossed at almost the same distance, their order is uncertain. The pixel is then added to
/// `undecided`; the voxels marked for it so far are correct. The grid spans all rays. About 1 ns per voxel.
void walk_pieces(const ProjectedImage& image, const VoxelLattice& lattice, std::span<const RayPiece> pieces,
                 VisitedGrid& grid, std::vector<std::uint32_t>& undecided);

}  // namespace octoskin
