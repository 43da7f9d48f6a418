// What the picture of a voxel, or of a brick of voxels, tells before any of its rays is looked at.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>

#include "host/core/bricks/brick_walk.hpp"
#include "host/core/depth/depth_frame.hpp"
#include "host/core/traversal/certain_view.hpp"
#include "host/core/traversal/mark_grid.hpp"
#include "host/core/traversal/reach_windows.hpp"

namespace octoskin {

/// Cubes are named by their centre in the camera's frame, metres, and their edge in voxels. Keeps references
/// to the view and to the image's windows.
class PictureTest {
  public:
    PictureTest(const CertainView& view, const ReachWindows& reach);

    /// No part of the cube is in the picture.
    [[nodiscard]] bool is_out_of_sight(const Eigen::Vector3d& centre, int voxels) const;
    /// The pixels that may see a cube; empty if that comes too near to the camera to tell.
    [[nodiscard]] std::optional<PixelBox> pixels_of(const Eigen::Vector3d& centre, int voxels) const;
    /// Those whose rays may pass a voxel, all if it comes near to the camera; empty if none does.
    [[nodiscard]] std::optional<PixelBox> pixels_of_voxel(const Eigen::Vector3d& centre) const;
    /// Around the pixel of any of a cube's voxels' centres it holds all pixels whose rays may pass that
    /// voxel.
    [[nodiscard]] SquareOfPixels square_of_voxels(const Eigen::Vector3d& centre, int voxels) const;
    /// Which of its voxels are passed for certain, by what the nearest pixels tell.
    [[nodiscard]] CubeVerdict of_cube(const Eigen::Vector3d& centre, int voxels) const;
    /// The longest reach in a box, or in one a little larger; negative if no pixel has a ray.
    [[nodiscard]] float longest(const PixelBox& box) const { return reach_.of(box).longest; }

  private:
    /// A voxel whose centre is seen at this slope has its corners no further off in the picture than this
    /// times the focal length by its nearest depth; the voxel a little enlarged, x or y of the camera.
    [[nodiscard]] double corner_m(Eigen::Index axis, double slope) const;

    const CertainView& view_;
    CameraIntrinsics camera_;
    std::array<Eigen::Vector3d, 4> sides_;  ///< of the picture: their planes' normals, inwards
    std::array<double, 4> half_edge_{};     ///< how far a voxel reaches along each, and the margin
    const ReachWindows& reach_;
};

}  // namespace octoskin
