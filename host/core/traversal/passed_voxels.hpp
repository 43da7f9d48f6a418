// Finds the voxels that the rays of a depth image pass: exactly those of OctoMap's computeUpdate.
//
// A voxel is certain if the ray of the pixel nearest to its centre passes the centre within half an edge and
// continues from there: the ray then passes the voxel or ends in it. This takes one look-up, and finds nearly
// all of free space. For another voxel, the rays of all pixels that see it are tested in single precision. A
// ray for which this gives no certain result is walked through the voxel in OctoMap's arithmetic.
// docs/concepts/sensor-models.md has the figure.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "host/core/bricks/brick.hpp"
#include "host/core/traversal/brick_visibility.hpp"
#include "host/core/traversal/certain_view.hpp"
#include "host/core/traversal/projected_image.hpp"
#include "host/core/traversal/range_pyramid.hpp"
#include "host/core/traversal/ray_pieces.hpp"
#include "host/core/traversal/voxel_rays.hpp"
#include "host/core/voxels/key_box.hpp"
#include "host/core/voxels/voxel_lattice.hpp"

namespace octoskin {

/// A value for each axis of the map.
using AlongAxes = std::array<float, 3>;

/// The rays of one image in one lattice. Keeps references to its arguments. Reuses its memory for the next
/// image. Several threads may ask at the same time.
class PassedVoxels {
  public:
    /// The view must have a `depth_max_m`, as that of a camera without lens distortion has. The image is from
    /// place_image(). `box` contains the ends of all rays and the camera.
    void begin(const CertainView& view, const ProjectedImage& image, const BrickVisibility& picture,
               const RangePyramid& reach, const VoxelLattice& lattice, const KeyBox& box);

    /// The voxels of a brick that a ray passes, without those in `ends`. `ends`: all voxels of the brick in
    /// which rays end at a surface. About 2 us near a surface, 0.3 us elsewhere.
    [[nodiscard]] BrickMask of(MortonCode brick, const BrickMask& ends) const;

    /// Data of the vector code, in the map's axes, metres. The direction of pixel (u, v), per metre of depth,
    /// is first + u * next_u + v * next_v.
    struct Kernel {
        VoxelRays::Kernel pixels;
        Walk walk;
        AlongAxes first{}, next_u{}, next_v{};
        /// Unit vectors along the map's axes, in the camera's frame.
        AlongAxes axes_x{}, axes_y{}, axes_z{};
        std::array<int, 3> origin_key{};
        /// Inward normals of the image's borders in the camera's frame, and how far inside a voxel that is in
        /// sight may be.
        std::array<std::array<float, 4>, 4> borders{};
        std::array<std::array<float, kBrickVoxels>, 3> offsets;  ///< from a brick's first voxel to each
        float half_smaller_m = 0.0F;                             ///< half edge of a slightly shrunk voxel
        float half_larger_m = 0.0F;                              ///< of a slightly enlarged one
        float half_depth_m = 0.0F;  ///< of the enlarged one, along the optical axis
    };

  private:
    const CertainView* view_ = nullptr;
    const BrickVisibility* picture_ = nullptr;
    const VoxelLattice* lattice_ = nullptr;
    Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();
    VoxelRays rays_;
    Kernel kernel_;
};

}  // namespace octoskin
