// Converts one depth image to the log-odds terms of its voxels. Holds no map: the terms are computed once and
// may be applied to several maps.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "common/result.hpp"
#include "host/core/depth/depth_frame.hpp"
#include "host/core/depth/pixel_rays.hpp"
#include "host/core/mapping/evidence.hpp"
#include "host/core/mapping/mapping_config.hpp"
#include "host/core/parallel/thread_pool.hpp"
#include "host/core/traversal/brick_visibility.hpp"
#include "host/core/traversal/certain_view.hpp"
#include "host/core/traversal/projected_image.hpp"
#include "host/core/voxels/key_box.hpp"

namespace octoskin {

/// Why a whole image was refused.
enum class DepthRejection : std::uint8_t {
    size_differs,        ///< the image's size differs from the camera's width and height
    pose_not_finite,     ///< T_map_camera has a NaN or an infinity
    camera_outside_map,  ///< the camera lies outside the octree
    box_too_large,       ///< the rays span more voxels than `MappingConfig::depth_box_voxels_max`
};

struct DepthUpdates {
    Evidence terms;
    Evidence retracted;  ///< of EndMemory, applied before `terms`; often empty
    DepthPixelCounts pixels;
};

/// What is known of one image beside its depths.
struct ImageNotes {
    std::optional<float> miss_log_odds = {};  ///< of a voxel that is only passed, if not the configured one
    /// As of DepthDenoiser; empty: no end is in doubt. With `denoised` and `paper`.
    std::span<const float> doubts_m = {};
};

/// Reuses its working memory between frames; not for concurrent use by two threads.
class DepthIntegrator {
  public:
    /// Takes the map's resolution, the model, the strategy and the memory limit from `config`. Every pixel
    /// must have a ray (asserted by PixelRays). `threads`: number of threads that work on an image, including
    /// the caller; the terms do not depend on it. The strategy `robust` runs in the caller only.
    DepthIntegrator(const MappingConfig& config, const CameraIntrinsics& camera, unsigned threads = 1);
    DepthIntegrator(DepthIntegrator&&) noexcept;
    DepthIntegrator& operator=(DepthIntegrator&&) noexcept;
    ~DepthIntegrator();

    /// Rays of the camera's pixels.
    [[nodiscard]] const PixelRays& pixel_rays() const noexcept { return pixel_rays_; }

    /// The rays of the last image that gave updates.
    [[nodiscard]] const ProjectedImage& rays() const noexcept;

    /// The terms of one image (depth along the optical axis, metres, NaN = none), filtered and without the
    /// robot, seen from `T_map_camera` (optical frame: z forward, x right, y down). Hit and passed voxels are
    /// those of OctoMap's `computeUpdate` without discretisation, with the maximum range `depth_range_max_m`;
    /// DepthUpdate defines the terms. O(pixels * range / resolution). Throws std::bad_alloc; the next image
    /// is not affected.
    [[nodiscard]] Result<DepthUpdates, DepthRejection> integrate(const DepthImage& image,
                                                                 const Eigen::Isometry3d& T_map_camera,
                                                                 const ImageNotes& notes = {});

  private:
    [[nodiscard]] Result<DepthUpdates, DepthRejection> updates_of(const DepthImage& image,
                                                                  const Eigen::Isometry3d& T_map_camera,
                                                                  const ImageNotes& notes);
    /// Each returns false if the rays span too many voxels.
    [[nodiscard]] bool take_sets(const ProjectedImage& rays, const Eigen::Isometry3d& T_map_camera,
                                 std::span<const float> doubts_m, Evidence& terms);
    [[nodiscard]] bool take_walked(const ProjectedImage& rays, const KeyBox& box, Evidence& terms);
    [[nodiscard]] bool take_means(const ProjectedImage& rays, Evidence& terms);
    [[nodiscard]] bool take_nearest(const ProjectedImage& rays, const CertainView& view, Evidence& terms);

    template <class AddBrick>
    void add_bricks(const KeyBox& box, const CertainView& view, const BrickVisibility& picture,
                    Evidence& terms, const AddBrick& add_brick);

    struct Workspace;
    MappingConfig config_;
    PixelRays pixel_rays_;
    VoxelLattice lattice_;
    std::unique_ptr<Workspace> workspace_;
    std::unique_ptr<ThreadPool> pool_;
};

}  // namespace octoskin
