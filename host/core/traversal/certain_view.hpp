// Which voxels are passed for certain, so that no ray need be walked through them.
//
// A voxel is certain if the ray of the pixel nearest to its centre passes its centre within half an edge and
// goes on from there: then it passes the voxel, or ends in it. That is one look-up, and while a pixel is
// smaller than a voxel it finds nearly all of free space. At the picture's edge, where a voxel is seen in
// part, and where the nearest pixel has no ray, all pixels that see the voxel are asked. docs/method.md has
// the figure.
#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <vector>

#include "host/core/depth/depth_frame.hpp"
#include "host/core/traversal/mark_grid.hpp"
#include "host/core/traversal/placed_image.hpp"
#include "host/core/traversal/ray_pieces.hpp"
#include "host/core/traversal/reach_windows.hpp"
#include "host/core/voxels/voxel_lattice.hpp"

namespace octoskin {

/// A camera at one pose over one lattice. Depths are along the optical axis, metres.
struct CertainView {
    /// Nothing is certain, and `depth_max_m` 0, for a camera with a lens, and where coordinates are so large
    /// that single precision is not much finer than a voxel.
    CertainView(const CameraIntrinsics& camera, const VoxelLattice& lattice,
                const Eigen::Isometry3d& T_map_camera, const PlacedImage& image);

    CameraIntrinsics camera;
    Eigen::Isometry3d T_camera_map;
    double resolution_m = 0.0;
    double radius_m = 0.0;      ///< of the sphere round a voxel
    double half_depth_m = 0.0;  ///< of a voxel, along the optical axis
    /// More than all that single precision gets wrong between here and a ray's end.
    double margin_m = 0.0;
    /// The nearest pixel's ray passes a voxel if its centre is no further: a pixel's corner lies within the
    /// sphere inside it.
    double depth_max_m = 0.0;
    /// Up to `depth_max_m` goes all that the rays pass, so that each voxel that is not certain can be asked
    /// for its rays; else rays are walked where not all they pass is certain.
    bool is_by_voxel = false;
};

/// In which voxels of a brick rays end in something; asked once at most of each.
using EndsOfBrick = std::function<BrickMask(MortonCode brick)>;

/// Marks voxels that a ray passes, or ends in: all of those up to `depth_max_m` for which the rays within
/// `WalkLadder`'s square go on from the voxel's centre (PlacedImage::passed_m), and others. Adds to `pieces`
/// the pieces of rays that perhaps pass a voxel and that no other ray passes for certain. The grid spans the
/// image's rays and has no mark. About 1 ns a voxel.
void mark_certain_voxels(const CertainView& view, const PlacedImage& image, const ReachWindows& reach,
                         const VoxelLattice& lattice, const EndsOfBrick& ends, MarkGrid& grid,
                         std::vector<RayPiece>& pieces);

}  // namespace octoskin
