#include "host/core/mapping/depth_integrator.hpp"

#include <cassert>
#include <cmath>
#include <utility>

#include "host/core/mapping/ray_walk.hpp"
#include "host/core/mapping/tally_grid.hpp"

namespace octoskin {
namespace {

/// A pixel's ray, placed in the map.
struct PixelRay {
    Eigen::Vector3f end;  ///< map frame, metres, in OctoMap's single precision
    VoxelKey end_key;
    float hit_term = 0.0F;
};

/// The paper's sets: a hit wins over any number of rays that passed, and the largest hit counts. A hit with a
/// term of 0 (too near to be trusted) is a hit all the same: it never turns into a miss.
float paper_term(const VoxelTally& tally, float miss) {
    return tally.hits > 0 ? tally.hit_max : miss;
}

/// The mean over the beams that have something to say about the voxel. A hit with a term of 0 is one of them.
float mean_term(const VoxelTally& tally, float miss) {
    const double sum = tally.hit_sum + static_cast<double>(miss) * tally.passed;
    return static_cast<float>(sum / (static_cast<double>(tally.hits) + tally.passed));
}

}  // namespace

/// What stays allocated from frame to frame.
struct DepthIntegrator::Workspace {
    std::vector<PixelRay> rays;
    TallyGrid grid;

    /// Places each pixel's ray; those that cannot be are counted.
    DepthPixelCounts place(const DepthImage& image, const PixelRays& pixel_rays, const HitModel& model,
                           const VoxelLattice& lattice, const Eigen::Isometry3d& T_map_camera);
    [[nodiscard]] KeyBox box_around(VoxelKey camera_key) const;
    void tally(const VoxelLattice& lattice, const Eigen::Vector3f& origin);
    /// What half an image has left in the grid must not meet the next one.
    void forget() noexcept { grid = TallyGrid(); }
};

DepthPixelCounts DepthIntegrator::Workspace::place(const DepthImage& image, const PixelRays& pixel_rays,
                                                   const HitModel& model, const VoxelLattice& lattice,
                                                   const Eigen::Isometry3d& T_map_camera) {
    DepthPixelCounts counts;
    rays.clear();
    std::size_t pixel = 0;
    for (std::uint32_t v = 0; v < image.height; ++v) {
        for (std::uint32_t u = 0; u < image.width; ++u, ++pixel) {
            const auto depth_m = static_cast<double>(image.depth_m[pixel]);
            if (std::isnan(depth_m)) {
                ++counts.no_value;
                continue;
            }
            if (!std::isfinite(depth_m) || depth_m <= 0.0) {
                ++counts.bad_value;
                continue;
            }
            const RaySlope ray = pixel_rays.at(u, v);
            const Eigen::Vector3d p_camera = depth_m * Eigen::Vector3d(ray.x, ray.y, 1.0);
            const Eigen::Vector3f end = (T_map_camera * p_camera).cast<float>();
            const auto end_key = lattice.key_of(end.cast<double>());
            if (!end_key) {
                ++counts.outside_map;
                continue;
            }
            rays.push_back({end, *end_key, model.log_odds(p_camera.norm())});
        }
    }
    counts.used = rays.size();
    return counts;
}

KeyBox DepthIntegrator::Workspace::box_around(VoxelKey camera_key) const {
    KeyBox box{camera_key, camera_key};
    for (const PixelRay& ray : rays) box.include(ray.end_key);
    return box;
}

void DepthIntegrator::Workspace::tally(const VoxelLattice& lattice, const Eigen::Vector3f& origin) {
    for (const PixelRay& pixel : rays) {
        const auto ray = plan_ray(lattice, origin, pixel.end);
        assert(ray.has_value());  // origin and end had keys when they were placed
        walk_ray(*ray, grid.indexing_of(*ray), [&](std::ptrdiff_t index) { grid.add_pass(index); });
        grid.add_hit(grid.index_of(pixel.end_key), pixel.hit_term);
    }
}

DepthIntegrator::DepthIntegrator(const MappingConfig& config, const CameraIntrinsics& camera)
    : config_(config),
      pixel_rays_(camera),
      lattice_(config.map.resolution_m),
      workspace_(std::make_unique<Workspace>()) {}
DepthIntegrator::DepthIntegrator(DepthIntegrator&&) noexcept = default;
DepthIntegrator& DepthIntegrator::operator=(DepthIntegrator&&) noexcept = default;
DepthIntegrator::~DepthIntegrator() = default;

Result<DepthUpdates, DepthRejection> DepthIntegrator::integrate(const DepthImage& image,
                                                                const Eigen::Isometry3d& T_map_camera) {
    const CameraIntrinsics& camera = pixel_rays_.camera();
    const std::size_t pixels = std::size_t{camera.width} * camera.height;
    if (image.width != camera.width || image.height != camera.height || image.depth_m.size() != pixels) {
        return unexpected(DepthRejection::size_differs);
    }
    if (!T_map_camera.matrix().allFinite()) return unexpected(DepthRejection::pose_not_finite);
    const Eigen::Vector3f origin = T_map_camera.translation().cast<float>();
    const auto camera_key = lattice_.key_of(origin.cast<double>());
    if (!camera_key) return unexpected(DepthRejection::camera_outside_map);

    try {
        return updates_of(image, T_map_camera, *camera_key);
    } catch (...) {  // no memory
        workspace_->forget();
        throw;
    }
}

Result<DepthUpdates, DepthRejection> DepthIntegrator::updates_of(const DepthImage& image,
                                                                 const Eigen::Isometry3d& T_map_camera,
                                                                 VoxelKey camera_key) {
    DepthUpdates result;
    result.pixels = workspace_->place(image, pixel_rays_, config_.model.depth, lattice_, T_map_camera);
    if (!workspace_->grid.span(workspace_->box_around(camera_key), config_.depth_box_voxels_max)) {
        return unexpected(DepthRejection::box_too_large);
    }
    workspace_->tally(lattice_, T_map_camera.translation().cast<float>());

    const float miss = config_.model.miss_log_odds;
    const bool is_paper = config_.depth_update == DepthUpdate::paper;
    workspace_->grid.drain([&](VoxelKey key, const VoxelTally& tally) {
        const float term = is_paper ? paper_term(tally, miss) : mean_term(tally, miss);
        if (term != 0.0F) result.updates.push_back({key, term});
    });
    return result;
}

}  // namespace octoskin
