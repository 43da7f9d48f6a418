// Finds the voxels that rays certainly pass, so that no ray need be walked through them.
//
// A voxel is certain if the ray of the pixel nearest to its centre passes the centre within half an edge and
// continues from there: the ray then passes the voxel or ends in it. This takes one look-up. While a pixel is
// smaller than a voxel it finds nearly all of free space. At the image border, where a voxel is visible only
// in part, and where the nearest pixel has no ray, all pixels that see the voxel are tested.
// docs/concepts/sensor-models.md has the figure.
#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <vector>

#include "host/core/depth/depth_frame.hpp"
#include "host/core/traversal/projected_image.hpp"
#include "host/core/traversal/range_pyramid.hpp"
#include "host/core/traversal/ray_pieces.hpp"
#include "host/core/traversal/visited_grid.hpp"
#include "host/core/voxels/voxel_lattice.hpp"

namespace octoskin {

/// A camera at one pose in a lattice. Depths are along the optical axis, metres.
struct CertainView {
    /// `depth_max_m` is 0 and no voxel is certain for a camera with a lens, and for coordinates so large that
    /// single precision is not much finer than a voxel.
    CertainView(const CameraIntrinsics& camera, const VoxelLattice& lattice,
                const Eigen::Isometry3d& T_map_camera, const ProjectedImage& image);

    CameraIntrinsics camera;
    Eigen::Isometry3d T_camera_map;
    double resolution_m = 0.0;
    double radius_m = 0.0;      ///< of the sphere around a voxel
    double half_depth_m = 0.0;  ///< of a voxel, along the optical axis
    /// Exceeds the error of single precision between the camera and the end of a ray.
    double margin_m = 0.0;
    /// Up to this depth of a voxel's centre, the nearest pixel's ray passes the voxel: the corner of a pixel
    /// lies within the voxel's inscribed sphere.
    double depth_max_m = 0.0;
    /// True if all rays lie within `depth_max_m`, so that the rays of each uncertain voxel can be tested.
    /// False: rays are walked where they pass uncertain voxels.
    bool is_by_voxel = false;
};

/// Returns the voxels of a brick in which rays end at a surface; called at most once per brick.
using EndsOfBrick = std::function<BrickMask(MortonCode brick)>;

/// Marks voxels that a ray passes or ends in: all voxels up to `depth_max_m` for which the rays within
/// `RaySegments`'s square continue from the voxel's centre (ProjectedImage::passed_m), and others. Adds to
/// `pieces` the pieces of rays that possibly pass a voxel that no other ray certainly passes. The grid spans
/// the image's rays and is clear. About 1 ns per voxel.
void mark_certain_voxels(const CertainView& view, const ProjectedImage& image, const RangePyramid& reach,
                         const VoxelLattice& lattice, const EndsOfBrick& ends, VisitedGrid& grid,
                         std::vector<RayPiece>& pieces);

}  // namespace octoskin
