#include "host/core/mapping/depth_integrator.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <limits>
#include <utility>

#include "host/core/bricks/brick_sets.hpp"
#include "host/core/bricks/brick_walk.hpp"
#include "host/core/mapping/hit_bricks.hpp"
#include "host/core/mapping/tally_grid.hpp"
#include "host/core/traversal/brick_visibility.hpp"
#include "host/core/traversal/end_voxels.hpp"
#include "host/core/traversal/image_traversal.hpp"
#include "host/core/traversal/passed_voxels.hpp"
#include "host/core/traversal/placed_voxels.hpp"
#include "host/core/traversal/visited_grid.hpp"
#include "host/core/traversal/voxel_rays.hpp"
#include "host/core/voxels/ray_walk.hpp"

namespace octoskin {
namespace {

/// The mean over the rays that pass the voxel or end in it. A hit with a term of 0 is included.
float mean_term(const VoxelTally& tally, float miss) {
    const double sum = tally.hit_sum + static_cast<double>(miss) * tally.passed;
    return static_cast<float>(sum / (static_cast<double>(tally.hits) + tally.passed));
}

KeyBox box_of(const ProjectedImage& rays, const VoxelLattice& lattice) {
    const auto lowest = lattice.key_of(rays.lowest.cast<double>());
    const auto highest = lattice.key_of(rays.highest.cast<double>());
    assert(lowest && highest);  // both are coordinates of ray ends and of the origin, which have keys
    return {*lowest, *highest};
}

/// Calls visit(end, range) for each pixel that has a ray, row by row.
template <class Visit>
void for_each_ray(const ProjectedImage& rays, Visit&& visit) {
    for (std::size_t i = 0; i < rays.pixels(); ++i) {
        if (rays.reach_m[i] < 0.0F) continue;
        visit(Eigen::Vector3f(rays.end_x[i], rays.end_y[i], rays.end_z[i]), rays.range_m[i]);
    }
}

/// Calls visit(key, range) for each ray that ends on a surface.
template <class Visit>
void for_each_hit(const ProjectedImage& rays, const VoxelLattice& lattice, Visit&& visit) {
    for_each_ray(rays, [&](const Eigen::Vector3f& end, double range_m) {
        if (range_m >= 0.0) visit(*lattice.key_of(end.cast<double>()), range_m);
    });
}

/// The mean over a voxel's rays of hit and miss terms if it is positive, otherwise 0: a voxel in which rays
/// end is never freed.
float voted_term(const RayVote& vote, float hit, float miss) {
    const auto end = static_cast<float>(vote.end);
    const auto go_on = static_cast<float>(vote.go_on);
    const float sum = hit * end + miss * go_on;
    return sum > 0.0F ? sum / (end + go_on) : 0.0F;
}

/// Size of one work item of the thread pool: 4 x 4 x 4 bricks.
constexpr unsigned kPartHeight = kBrickHeight + 2;

/// Aligned to cache lines of its own, because each hit writes its ends.
struct alignas(64) PartTerms {
    Evidence terms;
};

/// Calls add_below(terms, cube) for each cube in the thread pool, and joins the results in the order of the
/// cubes. `parts`: working memory.
template <class AddBelow>
void add_together(ThreadPool& pool, const std::vector<VoxelCube>& cubes, const AddBelow& add_below,
                  std::vector<PartTerms>& parts, Evidence& terms) {
    if (parts.size() < cubes.size()) parts.resize(cubes.size());
    pool.work(cubes.size(), [&](std::size_t i) {
        Evidence& own = parts[i].terms;
        own.clear();
        own.miss = terms.miss;
        add_below(own, cubes[i]);
    });
    for (std::size_t i = 0; i < cubes.size(); ++i) terms.append(parts[i].terms);
}

BrickMask without(BrickMask mask, const BrickMask& others) {
    for (std::size_t word = 0; word < mask.size(); ++word) mask[word] &= ~others[word];
    return mask;
}

/// A hit with a term of 0 is still a hit: its voxel is not in `passed`.
void add_sets(Evidence& terms, MortonCode brick, const BrickMask& passed, const BrickHits& hits) {
    terms.add(brick, passed);
    for_each_cell(hits.mask(), [&](std::size_t cell) {
        terms.add_cell(brick, {static_cast<std::uint16_t>(cell), hits.largest(cell)});
    });
}

constexpr BrickMask kAllVoxels = [] {
    BrickMask all;
    all.fill(~std::uint64_t{0});
    return all;
}();

/// Rounding may lead a ray one voxel out of the box.
KeyBox wider(const KeyBox& box) {
    const auto lower = [](std::uint16_t key) { return static_cast<std::uint16_t>(std::max(key - 1, 0)); };
    const auto higher = [](std::uint16_t key) {
        return static_cast<std::uint16_t>(std::min(key + 1, kVoxelsPerAxis - 1));
    };
    return {{lower(box.lowest.x), lower(box.lowest.y), lower(box.lowest.z)},
            {higher(box.highest.x), higher(box.highest.y), higher(box.highest.z)}};
}

}  // namespace

/// Memory that stays allocated between frames.
struct DepthIntegrator::Workspace {
    ProjectedImage rays;
    ImageTraversal traversal;
    VisitedGrid marks;
    HitBricks hits;
    EndVoxels ends;
    RangePyramid reach;
    VoxelRays voxel_rays;
    PassedVoxels passed;
    TallyGrid tallies;
    std::vector<PartTerms> parts;   ///< the evidence of each cube, before it is joined
    std::size_t bricks_before = 0;  ///< of the previous image: the next one has about as many
    std::size_t hits_before = 0;
};

DepthIntegrator::DepthIntegrator(const MappingConfig& config, const CameraIntrinsics& camera,
                                 unsigned threads)
    : config_(config),
      pixel_rays_(camera),
      lattice_(config.map.resolution_m),
      workspace_(std::make_unique<Workspace>()),
      pool_(std::make_unique<ThreadPool>(threads)) {}
DepthIntegrator::DepthIntegrator(DepthIntegrator&&) noexcept = default;
DepthIntegrator& DepthIntegrator::operator=(DepthIntegrator&&) noexcept = default;
DepthIntegrator::~DepthIntegrator() = default;

const ProjectedImage& DepthIntegrator::rays() const noexcept {
    return workspace_->rays;
}

Result<DepthUpdates, DepthRejection> DepthIntegrator::integrate(const DepthImage& image,
                                                                const Eigen::Isometry3d& T_map_camera,
                                                                const ImageNotes& notes) {
    const CameraIntrinsics& camera = pixel_rays_.camera();
    const std::size_t pixels = std::size_t{camera.width} * camera.height;
    if (image.width != camera.width || image.height != camera.height || image.depth_m.size() != pixels) {
        return unexpected(DepthRejection::size_differs);
    }
    if (!T_map_camera.matrix().allFinite()) return unexpected(DepthRejection::pose_not_finite);
    const Eigen::Vector3f origin = T_map_camera.translation().cast<float>();
    if (!lattice_.key_of(origin.cast<double>())) return unexpected(DepthRejection::camera_outside_map);

    try {
        return updates_of(image, T_map_camera, notes);
    } catch (...) {  // no memory: the next image must not find data of an unfinished one
        *workspace_ = {};
        throw;
    }
}

Result<DepthUpdates, DepthRejection> DepthIntegrator::updates_of(const DepthImage& image,
                                                                 const Eigen::Isometry3d& T_map_camera,
                                                                 const ImageNotes& notes) {
    ProjectedImage& rays = workspace_->rays;
    const auto place = [&](auto& place_how) {
        place_how(image, pixel_rays_, lattice_, T_map_camera, config_.depth_range_max_m, rays, pool_.get());
    };
    const bool takes_voxels =
        config_.depth_update == DepthUpdate::fast && pixel_rays_.camera().lens.is_none();
    takes_voxels ? place(place_voxels) : place(place_image);
    DepthUpdates result;
    result.pixels = rays.counts;
    Evidence& terms = result.terms;
    terms.miss = notes.miss_log_odds.value_or(config_.model.miss_log_odds);
    terms.bricks.reserve(workspace_->bricks_before);
    terms.cells.reserve(workspace_->hits_before);
    bool has_room = false;
    switch (config_.depth_update) {
        case DepthUpdate::paper:
        case DepthUpdate::denoised:
            has_room = take_sets(rays, T_map_camera, notes.doubts_m, terms);
            break;
        case DepthUpdate::robust:
            has_room = take_means(rays, terms);
            break;
        case DepthUpdate::fast: {
            const CertainView view(pixel_rays_.camera(), lattice_, T_map_camera, rays);
            if (view.depth_max_m > 0.0) {
                has_room = take_nearest(rays, view, terms);
            } else {
                if (takes_voxels) place(place_image);
                has_room = take_means(rays, terms);
            }
            break;
        }
    }
    if (!has_room) return unexpected(DepthRejection::box_too_large);
    workspace_->bricks_before = terms.bricks.size();
    workspace_->hits_before = terms.cells.size();
    return result;
}

/// Calls add_brick(terms, brick, is_all) for each brick of the box that rays may pass, in Morton order.
/// `is_all`: they pass all of its voxels. In the thread pool, with evidence of its own for each part.
template <class AddBrick>
void DepthIntegrator::add_bricks(const KeyBox& box, const CertainView& view, const BrickVisibility& picture,
                                 Evidence& terms, const AddBrick& add_brick) {
    const auto coverage_of = [&](const VoxelCube& cube) {
        const int edge = 1 << cube.height;
        const Eigen::Vector3d half = Eigen::Vector3d::Constant(0.5 * (edge - 1) * lattice_.resolution_m());
        return picture.of_cube(view.T_camera_map * (lattice_.centre_of(cube.lowest) + half), edge);
    };
    const auto add_below = [&](Evidence& to, const VoxelCube& cube) {
        walk_bricks(
            box, coverage_of, [&](MortonCode brick, bool is_all) { add_brick(to, brick, is_all); }, cube);
    };
    if (pool_->size() == 1) return add_below(terms, kWholeOctree);
    std::vector<VoxelCube> cubes;
    walk_cubes(box, kPartHeight, coverage_of, [&](const VoxelCube& cube, bool) { cubes.push_back(cube); });
    add_together(*pool_, cubes, add_below, workspace_->parts, terms);
}

/// The paper's sets: a hit wins over any number of passing rays, and the largest hit counts. A hit with a
/// term of 0 (too near to be reliable) is still a hit: it never becomes a miss.
bool DepthIntegrator::take_sets(const ProjectedImage& rays, const Eigen::Isometry3d& T_map_camera,
                                std::span<const float> doubts_m, Evidence& terms) {
    HitBricks& hits = workspace_->hits;
    RangePyramid& reach = workspace_->reach;
    const KeyBox box = box_of(rays, lattice_);
    reach.begin(rays);
    bool has_room = false;
    pool_->work(3, [&](std::size_t part) {
        if (part == 0)
            has_room = hits.take(rays, {doubts_m, lattice_.resolution_m()}, box, config_.model.depth,
                                 config_.depth_box_voxels_max);
        if (part == 1) reach.take_shortest(rays);
        if (part == 2) reach.take_longest(rays);
    });
    if (!has_room) return false;
    const CertainView view(pixel_rays_.camera(), lattice_, T_map_camera, rays);
    if (!(view.depth_max_m > 0.0)) return take_walked(rays, box, terms);
    const BrickVisibility picture(view, reach);
    PassedVoxels& passed = workspace_->passed;
    passed.begin(view, rays, picture, reach, lattice_, box);
    add_bricks(wider(box), view, picture, terms, [&](Evidence& to, MortonCode brick, bool is_all) {
        const BrickHits found = hits.of(brick);
        add_sets(to, brick, is_all ? without(kAllVoxels, found.mask()) : passed.of(brick, found.mask()),
                 found);
    });
    return true;
}

/// The same by walking each ray.
bool DepthIntegrator::take_walked(const ProjectedImage& rays, const KeyBox& box, Evidence& terms) {
    VisitedGrid& marks = workspace_->marks;
    if (!marks.span(box.lowest, box.highest, config_.depth_box_voxels_max)) return false;
    workspace_->traversal.mark_passed(rays, lattice_, marks);
    marks.drain([&](MortonCode brick, const BrickMask& passed) {
        const BrickHits found = workspace_->hits.of(brick);
        add_sets(terms, brick, without(passed, found.mask()), found);
    });
    return true;
}

bool DepthIntegrator::take_means(const ProjectedImage& rays, Evidence& terms) {
    TallyGrid& tallies = workspace_->tallies;
    if (!tallies.span(box_of(rays, lattice_), config_.depth_box_voxels_max)) return false;
    for_each_ray(rays, [&](const Eigen::Vector3f& end, double) {
        const auto ray = plan_ray(lattice_, rays.origin, end);
        assert(ray.has_value());  // origin and end have keys since they were placed
        walk_ray(*ray, tallies.indexing_of(*ray), [&](std::ptrdiff_t index) { tallies.add_pass(index); });
    });
    for_each_hit(rays, lattice_, [&](VoxelKey key, double range_m) {
        tallies.add_hit(tallies.index_of(key), config_.model.depth.log_odds(range_m));
    });
    std::vector<VoxelUpdate> updates;
    tallies.drain([&](VoxelKey key, const VoxelTally& tally) {
        updates.push_back({key, mean_term(tally, config_.model.miss_log_odds)});
    });
    terms.take_image(std::move(updates));
    return true;
}

bool DepthIntegrator::take_nearest(const ProjectedImage& rays, const CertainView& view, Evidence& terms) {
    EndVoxels& ends = workspace_->ends;
    const KeyBox box = box_of(rays, lattice_);
    RangePyramid& reach = workspace_->reach;
    const std::size_t parts = pool_->size();
    if (!ends.begin(box, config_.depth_box_voxels_max, parts)) return false;
    reach.begin(rays);
    pool_->work(parts + 2, [&](std::size_t part) {
        if (part < parts) return ends.mark(rays, part);
        part == parts ? reach.take_shortest(rays) : reach.take_longest(rays);
    });
    const BrickVisibility picture(view, reach);
    VoxelRays& voxel_rays = workspace_->voxel_rays;
    voxel_rays.begin(view, rays, reach, lattice_);
    add_bricks(box, view, picture, terms, [&](Evidence& to, MortonCode brick, bool is_all) {
        if (is_all) return to.add(brick, kAllVoxels);
        const VoxelRays::Brick place = voxel_rays.brick_at(key_of_morton(brick));
        const BrickMask hit = ends.of(brick);
        to.add(brick, without(voxel_rays.passed(place, hit), hit));
        if (count_of(hit) == 0) return;
        std::array<RayVote, kBrickVoxels> votes;
        voxel_rays.vote_on(place, hit, votes);
        for_each_cell(hit, [&](std::size_t cell) {
            const auto range_m = static_cast<double>(voxel_rays.range_m(place, cell));
            const float term = voted_term(votes[cell], config_.model.depth.log_odds(range_m), terms.miss);
            to.add_cell(brick, {static_cast<std::uint16_t>(cell), term});
        });
    });
    return true;
}

}  // namespace octoskin
