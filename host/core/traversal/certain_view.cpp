#include "host/core/traversal/certain_view.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace octoskin {

CertainView::CertainView(const CameraIntrinsics& intrinsics, const VoxelLattice& lattice,
                         const Eigen::Isometry3d& T_map_camera, const ProjectedImage& image)
    : camera(intrinsics),
      T_camera_map(T_map_camera.inverse()),
      resolution_m(lattice.resolution_m()),
      radius_m(0.5 * std::numbers::sqrt3 * resolution_m),
      half_depth_m(0.5 * resolution_m * T_map_camera.linear().col(2).lpNorm<1>()) {
    const double extent_m = static_cast<double>(
        std::max(image.lowest.cwiseAbs().maxCoeff(), image.highest.cwiseAbs().maxCoeff()));
    margin_m = 1e-3 * resolution_m + 4e-6 * extent_m;
    if (!camera.lens.is_none() || margin_m > 0.05 * resolution_m) return;
    depth_max_m = (0.5 * resolution_m - margin_m) * std::min(camera.fx, camera.fy) * std::numbers::sqrt2;
}

}  // namespace octoskin
