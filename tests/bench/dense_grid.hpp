// A dense grid of log-odds: what a user writes in an hour. For each voxel that the camera may see the nearest
// pixel: free before its depth, occupied at it. No bounds on memory; thin things are lost.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <vector>

#include "host/core/depth/depth_frame.hpp"

namespace octoskin::bench {

class DenseGrid {
  public:
    /// `box`: map frame, metres. 4 bytes for each voxel.
    DenseGrid(const Eigen::AlignedBox3f& box, float resolution_m);

    /// Of a pinhole camera. What lies outside the box is left out. O(voxels of the box of the view).
    void insert(const DepthImage& image, const CameraIntrinsics& camera,
                const Eigen::Isometry3d& T_map_camera);
    /// The box of all that a camera sees up to the furthest pixel and the maximum range.
    [[nodiscard]] static Eigen::AlignedBox3f seen(const DepthImage& image, const CameraIntrinsics& camera,
                                                  const Eigen::Isometry3d& T_map_camera);
    [[nodiscard]] std::size_t bytes() const noexcept { return log_odds_.size() * sizeof(float); }
    [[nodiscard]] std::size_t known() const;

  private:
    Eigen::Vector3f lowest_;
    float resolution_m_;
    Eigen::Array3i size_;
    std::vector<float> log_odds_;  ///< x fastest; 0: unknown
};

}  // namespace octoskin::bench
