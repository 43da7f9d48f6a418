// Finds the rays of an image that pass through a voxel, and their effect on it: the query of the depth update
// `fast`.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "host/core/bricks/brick.hpp"
#include "host/core/traversal/certain_view.hpp"
#include "host/core/traversal/projected_image.hpp"
#include "host/core/traversal/range_pyramid.hpp"
#include "host/core/voxels/voxel_lattice.hpp"

namespace octoskin {

/// Votes of a voxel's rays, which are the rays inside it at the depth of its centre.
struct RayVote {
    std::uint32_t end = 0;    ///< end in the voxel, before its centre or less than 0.2 edges behind it
    std::uint32_t go_on = 0;  ///< end further away; their surface may be behind the voxel
};

/// The rays of one image in one lattice; docs/concepts/sensor-models.md has the figure. All values are in the
/// camera's frame and in single precision. Keeps references to its arguments. Reuses its memory for the next
/// image.
class VoxelRays {
  public:
    /// The view must have a `depth_max_m`, as that of a camera without lens distortion has.
    void begin(const CertainView& view, const ProjectedImage& image, const RangePyramid& reach,
               const VoxelLattice& lattice);

    /// Centre of a brick's first voxel in the camera's frame, metres.
    struct Brick {
        float x = 0.0F, y = 0.0F, z = 0.0F;
    };
    [[nodiscard]] Brick brick_at(VoxelKey lowest) const;
    /// The voxels of a brick that at least one of their rays passes or ends in. Some of those in `ends`,
    /// where rays end at a surface, are left out. The eight cubes of 4 x 4 x 4 are tested together first: for
    /// most of them the result is all or none. In the others most voxels take one look-up, of the pixel
    /// nearest to the centre; all rays of a voxel are tested only if that gives no decision. All of these
    /// voxels are among the free or occupied ones of OctoMap's computeUpdate. About 1 us.
    [[nodiscard]] BrickMask passed(const Brick& brick, const BrickMask& ends) const;
    /// Sets the votes of the given voxels, by cell; other votes are left unchanged. A voxel that is not
    /// completely in front of the camera gets no votes.
    void vote_on(const Brick& brick, const BrickMask& voxels, std::span<RayVote, kBrickVoxels> votes) const;
    /// Distance from the camera to a voxel's centre, metres.
    [[nodiscard]] float range_m(const Brick& brick, std::size_t cell) const noexcept;

    /// Data of the vector code.
    struct Kernel {
        std::array<std::array<float, kBrickVoxels>, 3> offsets;  ///< from the first voxel's centre to each
        std::array<std::array<float, 8>, 3> middles;  ///< from there to the middle of each word of a mask
        /// Map-axis components of the camera's x and y.
        std::array<std::array<float, 2>, 3> across;
        const float* passed_m = nullptr;
        const float* reach_m = nullptr;
        std::uint32_t width = 0;
        std::uint32_t height = 0;
        float last_u = 0.0F, last_v = 0.0F;
        float fx = 0.0F, fy = 0.0F;
        float per_fx = 0.0F, per_fy = 0.0F;
        float u_centre = 0.0F,
              v_centre = 0.0F;  ///< optical axis, in pixels from the first one's centre
        /// How far from the middle of a word's voxels their rays may be, along the camera's x and y, and how
        /// far behind and before it their depths.
        float word_x_m = 0.0F, word_y_m = 0.0F, word_depth_m = 0.0F;
        float inside_m = 0.0F;       ///< from a voxel's centre to its faces, less the margin
        float near_centre_m = 0.0F;  ///< a ray within this distance of the centre counts for it
        float half_edge_m = 0.0F;
        float half_depth_m = 0.0F;
        float end_m = 0.0F;  ///< a ray that ends up to this far behind the centre ends in the voxel
        float near_m = 0.0F;
        float margin_m = 0.0F;
        float depth_max_m = 0.0F;
        std::uint32_t blocks_width = 0;
        std::array<const float*, RangePyramid::kLevels> shortest_m{};
        std::array<const float*, RangePyramid::kLevels> longest_m{};
    };

    [[nodiscard]] const Kernel& kernel() const noexcept { return kernel_; }

  private:
    const CertainView* view_ = nullptr;
    const RangePyramid* reach_ = nullptr;
    const VoxelLattice* lattice_ = nullptr;
    Kernel kernel_;
};

}  // namespace octoskin
