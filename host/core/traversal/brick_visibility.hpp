// Brick visibility test: decides by the image of a voxel or a brick, before any of its rays is read.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>

#include "host/core/bricks/brick_walk.hpp"
#include "host/core/depth/depth_frame.hpp"
#include "host/core/traversal/certain_view.hpp"
#include "host/core/traversal/range_pyramid.hpp"
#include "host/core/traversal/visited_grid.hpp"

namespace octoskin {

/// Cubes are given by their centre in the camera's frame, metres, and their edge in voxels. Keeps references
/// to the view and to the image's range pyramid.
class BrickVisibility {
  public:
    BrickVisibility(const CertainView& view, const RangePyramid& reach);

    /// True if no part of the cube is in the image.
    [[nodiscard]] bool is_out_of_sight(const Eigen::Vector3d& centre, int voxels) const;
    /// The pixels that may see a cube; empty if the cube is too near to the camera for a decision.
    [[nodiscard]] std::optional<PixelBox> pixels_of(const Eigen::Vector3d& centre, int voxels) const;
    /// A square that, around the pixel of the centre of any voxel of the cube, contains all pixels whose rays
    /// may pass that voxel.
    [[nodiscard]] SquareOfPixels square_of_voxels(const Eigen::Vector3d& centre, int voxels) const;
    /// The cube's voxels that are certainly passed, as far as the range pyramid decides it.
    [[nodiscard]] CubeCoverage of_cube(const Eigen::Vector3d& centre, int voxels) const;
    /// The longest reach in a box, or in a slightly larger one; negative if no pixel has a ray.
    [[nodiscard]] float longest(const PixelBox& box) const { return reach_.of(box).longest; }

  private:
    /// Upper bound for the image distance of a voxel's corners from its centre seen at this slope: the result
    /// times the focal length, divided by the voxel's nearest depth. The voxel is slightly enlarged; x or y
    /// of the camera.
    [[nodiscard]] double corner_m(Eigen::Index axis, double slope) const;

    const CertainView& view_;
    CameraIntrinsics camera_;
    std::array<Eigen::Vector3d, 4> sides_;  ///< normals of the image border planes, inwards
    std::array<double, 4> half_edge_{};     ///< half extent of a voxel along each normal, plus the margin
    const RangePyramid& reach_;
};

}  // namespace octoskin
