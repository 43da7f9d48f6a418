#include "host/core/mapping/depth_integrator.hpp"

#include <cassert>
#include <cmath>
#include <utility>

#include "host/core/mapping/hit_table.hpp"
#include "host/core/mapping/tally_grid.hpp"
#include "host/core/traversal/image_traversal.hpp"
#include "host/core/traversal/mark_grid.hpp"
#include "host/core/voxels/ray_walk.hpp"

namespace octoskin {
namespace {

/// The mean over the beams that have something to say about the voxel. A hit with a term of 0 is one of them.
float mean_term(const VoxelTally& tally, float miss) {
    const double sum = tally.hit_sum + static_cast<double>(miss) * tally.passed;
    return static_cast<float>(sum / (static_cast<double>(tally.hits) + tally.passed));
}

KeyBox box_of(const PlacedImage& rays, const VoxelLattice& lattice) {
    const auto lowest = lattice.key_of(rays.lowest.cast<double>());
    const auto highest = lattice.key_of(rays.highest.cast<double>());
    assert(lowest && highest);  // they are coordinates of ends and of the origin
    return {*lowest, *highest};
}

/// Calls visit(end, range) for each pixel that has a ray, row by row.
template <class Visit>
void for_each_ray(const PlacedImage& rays, Visit&& visit) {
    for (std::size_t i = 0; i < rays.range_m.size(); ++i) {
        if (rays.reach_m[i] < 0.0F) continue;
        visit(Eigen::Vector3f(rays.end_x[i], rays.end_y[i], rays.end_z[i]), rays.range_m[i]);
    }
}

/// Calls visit(key, range) for each ray that ends in something.
template <class Visit>
void for_each_hit(const PlacedImage& rays, const VoxelLattice& lattice, Visit&& visit) {
    for_each_ray(rays, [&](const Eigen::Vector3f& end, double range_m) {
        if (range_m >= 0.0) visit(*lattice.key_of(end.cast<double>()), range_m);
    });
}

}  // namespace

/// What stays allocated from frame to frame.
struct DepthIntegrator::Workspace {
    PlacedImage rays;
    ImageTraversal traversal;
    MarkGrid marks;
    HitTable hits;
    TallyGrid tallies;
    std::size_t updates_before = 0;  ///< of the image before: this one will have about as many
};

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
    if (!lattice_.key_of(origin.cast<double>())) return unexpected(DepthRejection::camera_outside_map);

    try {
        return updates_of(image, T_map_camera);
    } catch (...) {  // no memory: what half an image has left behind must not meet the next one
        *workspace_ = {};
        throw;
    }
}

Result<DepthUpdates, DepthRejection> DepthIntegrator::updates_of(const DepthImage& image,
                                                                 const Eigen::Isometry3d& T_map_camera) {
    PlacedImage& rays = workspace_->rays;
    place_image(image, pixel_rays_, lattice_, T_map_camera, config_.depth_range_max_m, rays);
    DepthUpdates result;
    result.pixels = rays.counts;
    const bool has_room = config_.depth_update == DepthUpdate::paper
                              ? take_sets(rays, T_map_camera, result.updates)
                              : take_means(rays, result.updates);
    if (!has_room) return unexpected(DepthRejection::box_too_large);
    return result;
}

/// The paper's sets: a hit wins over any number of rays that passed, and the largest hit counts. A hit with a
/// term of 0 (too near to be trusted) is a hit all the same: it never turns into a miss.
bool DepthIntegrator::take_sets(const PlacedImage& rays, const Eigen::Isometry3d& T_map_camera,
                                std::vector<VoxelUpdate>& updates) {
    MarkGrid& marks = workspace_->marks;
    const KeyBox box = box_of(rays, lattice_);
    if (!marks.span(box.lowest, box.highest, config_.depth_box_voxels_max)) return false;
    workspace_->traversal.mark_passed(rays, pixel_rays_, lattice_, T_map_camera, marks);
    HitTable& hits = workspace_->hits;
    hits.begin(rays.counts.used);
    for_each_hit(rays, lattice_, [&](VoxelKey key, double range_m) {
        const std::ptrdiff_t voxel = marks.index_of(key);
        marks.marks()[voxel] = MarkGrid::kHit;
        hits.add(voxel, config_.model.depth.log_odds(range_m));
    });
    hits.finish();
    const float miss = config_.model.miss_log_odds;
    updates.reserve(workspace_->updates_before);
    marks.drain([&](VoxelKey key, std::uint8_t mark) {
        const float term = mark == MarkGrid::kHit ? hits.largest(marks.index_of(key)) : miss;
        if (term != 0.0F) updates.push_back({key, term});
    });
    workspace_->updates_before = updates.size();
    return true;
}

bool DepthIntegrator::take_means(const PlacedImage& rays, std::vector<VoxelUpdate>& updates) {
    TallyGrid& tallies = workspace_->tallies;
    if (!tallies.span(box_of(rays, lattice_), config_.depth_box_voxels_max)) return false;
    for_each_ray(rays, [&](const Eigen::Vector3f& end, double) {
        const auto ray = plan_ray(lattice_, rays.origin, end);
        assert(ray.has_value());  // origin and end had keys when they were placed
        walk_ray(*ray, tallies.indexing_of(*ray), [&](std::ptrdiff_t index) { tallies.add_pass(index); });
    });
    for_each_hit(rays, lattice_, [&](VoxelKey key, double range_m) {
        tallies.add_hit(tallies.index_of(key), config_.model.depth.log_odds(range_m));
    });
    tallies.drain([&](VoxelKey key, const VoxelTally& tally) {
        const float term = mean_term(tally, config_.model.miss_log_odds);
        if (term != 0.0F) updates.push_back({key, term});
    });
    return true;
}

}  // namespace octoskin
