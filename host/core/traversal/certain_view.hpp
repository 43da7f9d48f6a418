// A camera at one pose in a lattice, and up to which depth a voxel is larger than a pixel.
#pragma once

#include <Eigen/Geometry>

#include "host/core/depth/depth_frame.hpp"
#include "host/core/traversal/projected_image.hpp"
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
};

}  // namespace octoskin
