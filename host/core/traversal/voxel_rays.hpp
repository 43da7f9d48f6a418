// Which rays of an image a voxel sees, and what they do there: the question that the depth update `fast`
// asks.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "host/core/bricks/brick.hpp"
#include "host/core/traversal/certain_view.hpp"
#include "host/core/traversal/placed_image.hpp"
#include "host/core/traversal/reach_windows.hpp"
#include "host/core/voxels/voxel_lattice.hpp"

namespace octoskin {

/// A voxel's rays are those that are in it at its centre's depth. How many of them...
struct RayVote {
    std::uint32_t end = 0;    ///< ... end in the voxel, before its centre or less than 0.2 edges behind it
    std::uint32_t go_on = 0;  ///< ... end further away: what they end in may lie behind the voxel
};

/// Rays of one image over one lattice; docs/method.md has the figure. What all of it is made of is in the
/// camera's frame and single precision. Keeps references to what it is made from, and its memory.
class VoxelRays {
  public:
    /// The view has a `depth_max_m`: a camera without a lens.
    void begin(const CertainView& view, const PlacedImage& image, const ReachWindows& reach,
               const VoxelLattice& lattice);

    /// A brick's first voxel, in the camera's frame, metres.
    struct Brick {
        float x = 0.0F, y = 0.0F, z = 0.0F;
    };
    [[nodiscard]] Brick brick_at(VoxelKey lowest) const;
    /// The voxels of a brick that a ray of theirs passes or ends in; but for some of those in which rays end
    /// in something, which are given. Its eight cubes of 4 x 4 x 4 are looked at together: of most all voxels
    /// are, or none. In the others, one look-up for most, that of the pixel nearest to the centre; all of a
    /// voxel's rays for those where that one does not. None that OctoMap's computeUpdate has not among its
    /// free or occupied ones. About 1 us.
    [[nodiscard]] BrickMask passed(const Brick& brick, const BrickMask& ends) const;
    /// Of those voxels, by their cell; the others' votes stay as they are. None of a voxel that is not wholly
    /// before the camera.
    void vote_on(const Brick& brick, const BrickMask& voxels, std::span<RayVote, kBrickVoxels> votes) const;
    /// From the camera to a voxel's centre.
    [[nodiscard]] float range_m(const Brick& brick, std::size_t cell) const noexcept;

    /// What a kernel works with.
    struct Kernel {
        std::array<std::array<float, kBrickVoxels>, 3> offsets;  ///< from the first voxel's centre to each
        std::array<std::array<float, 8>, 3> middles;  ///< and to the middle of each word of a BrickMask
        /// What camera x and y add along each axis of the map.
        std::array<std::array<float, 2>, 3> across;
        const float* passed_m = nullptr;
        const float* reach_m = nullptr;
        std::uint32_t width = 0;
        std::uint32_t height = 0;
        float last_u = 0.0F, last_v = 0.0F;
        float fx = 0.0F, fy = 0.0F;
        float per_fx = 0.0F, per_fy = 0.0F;
        float u_centre = 0.0F, v_centre = 0.0F;  ///< the optical axis, in pixels from the first one's centre
        float half_x_m = 0.0F, half_y_m = 0.0F;  ///< a voxel reaches no further along the camera's x and y
        float inside_m = 0.0F;                   ///< from a voxel's centre to its faces, less the margin
        float near_centre_m = 0.0F;  ///< a ray that passes so near to the centre speaks for the voxel
        float half_edge_m = 0.0F;
        float half_depth_m = 0.0F;
        float end_m = 0.0F;  ///< a ray that ends so far behind the centre ends in the voxel
        float near_m = 0.0F;
        float margin_m = 0.0F;
        float depth_max_m = 0.0F;
        std::uint32_t blocks_width = 0;
        std::array<const float*, ReachWindows::kLevels> shortest_m{};
        std::array<const float*, ReachWindows::kLevels> longest_m{};
    };

  private:
    const CertainView* view_ = nullptr;
    const ReachWindows* reach_ = nullptr;
    const VoxelLattice* lattice_ = nullptr;
    Kernel kernel_;
};

}  // namespace octoskin
