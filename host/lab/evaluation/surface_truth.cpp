#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "host/core/voxels/voxel_lattice.hpp"
#include "host/lab/evaluation/truth.hpp"

namespace octoskin::evaluation {
namespace {

/// About five minutes of computing; hundreds of times as many as the shipped worlds have.
constexpr double kSurfacePointsMax = 1e9;

KeyBox with_margins(const KeyBox& region, const TruthConfig& config) {
    return region.padded(std::max(config.occlusion_margin_voxels, config.tolerance_voxels));
}

/// The world's share of a box of voxels: an axis-parallel box in the base frame that covers it.
Eigen::AlignedBox3d base_bounds(const KeyBox& box, const VoxelLattice& lattice,
                                const Eigen::Isometry3d& T_map_base) {
    const Eigen::Vector3d half = Eigen::Vector3d::Constant(lattice.resolution_m() / 2.0);
    const Eigen::AlignedBox3d map_bounds(lattice.centre_of(box.min) - half,
                                         lattice.centre_of(box.max) + half);
    return map_bounds.transformed(T_map_base.inverse());
}

void mark(VoxelMask& mask, const VoxelLattice& lattice, const Eigen::Vector3d& p_map) {
    const auto key = lattice.key_of(p_map);
    if (key && mask.box().contains(*key)) {
        mask.at(*key) = 1;
    }
}

struct SurfaceMasks {
    VoxelMask any;
    VoxelMask hidden;
};

SurfaceMasks surface_masks(const sim::World& world, const TruthConfig& config, const KeyBox& box,
                           const Eigen::Isometry3d& T_map_base) {
    const VoxelLattice lattice(config.resolution_m);
    std::vector<bool> is_hidden;
    for (const auto& solid : world.solids()) {
        is_hidden.push_back(std::ranges::find(config.hidden_models, solid.model) !=
                            config.hidden_models.end());
    }
    SurfaceMasks masks{VoxelMask(box), VoxelMask(box)};
    world.sample_surfaces(config.surface_pitch_m, base_bounds(box, lattice, T_map_base),
                          [&](const Eigen::Vector3d& p_base, std::uint32_t solid) {
                              const Eigen::Vector3d p_map = T_map_base * p_base;
                              mark(masks.any, lattice, p_map);
                              if (is_hidden[solid]) {
                                  mark(masks.hidden, lattice, p_map);
                              }
                          });
    return masks;
}

VoxelMask seen_mask(const sim::World& world, const TruthConfig& config, const KeyBox& box,
                    const Eigen::Isometry3d& T_map_base) {
    VoxelMask seen(box);
    const VoxelLattice lattice(config.resolution_m);
    for (const rig::Camera& camera : config.external_cameras) {
        for (const auto& p_base : render_view(world, camera, camera.T_link_camera, 1).p_base_points) {
            mark(seen, lattice, T_map_base * p_base.cast<double>());
        }
    }
    return seen;
}

}  // namespace

std::optional<Error> surface_fault(const sim::World& world, const TruthConfig& config, const KeyBox& region,
                                   const Eigen::Isometry3d& T_map_base) {
    const auto bounds =
        base_bounds(with_margins(region, config), VoxelLattice(config.resolution_m), T_map_base);
    const double points = world.samples_within(config.surface_pitch_m, bounds);
    if (points <= kSurfacePointsMax) return std::nullopt;
    return Error{.code = ErrorCode::limit_exceeded,
                 .what = fmt::format("expected at most {:.0g} points of the world's surfaces in the judged "
                                     "region",
                                     kSurfacePointsMax),
                 .value = fmt::format("{:.2g}", points),
                 .remedy = "make the region smaller, or the world's meshes coarser"};
}

VoxelGrid<SurfaceVoxel> surface_truth(const sim::World& world, const TruthConfig& config,
                                      const KeyBox& region, const Eigen::Isometry3d& T_map_base) {
    const KeyBox box = with_margins(region, config);
    const auto [surface, hidden] = surface_masks(world, config, box, T_map_base);
    const VoxelMask seen = seen_mask(world, config, box, T_map_base);
    const VoxelMask near_surface = dilated(surface, config.tolerance_voxels);
    const VoxelMask near_seen = dilated(seen, config.occlusion_margin_voxels);

    const VoxelLattice lattice(config.resolution_m);
    const Eigen::Isometry3d T_base_map = T_map_base.inverse();
    VoxelGrid<SurfaceVoxel> truth(region);
    for (std::size_t i = 0; i < truth.size(); ++i) {
        const VoxelKey key = region.key_at(i);
        const std::size_t j = box.index_of(key);
        const bool is_surface = surface[j] != 0;
        truth[i] = {.is_surface = is_surface,
                    .is_near_surface = near_surface[j] != 0,
                    .is_interior = !is_surface && world.is_inside(T_base_map * lattice.centre_of(key)),
                    .is_hidden_object = hidden[j] != 0,
                    .is_seen = seen[j] != 0,
                    .is_occluded = is_surface && near_seen[j] == 0};
    }
    return truth;
}

Result<Truth, Error> build_truth(const sim::World& world, const Survey& survey, const TruthConfig& config,
                                 const Eigen::Isometry3d& T_map_base) {
    const KeyBox region = region_of(config.region, config.resolution_m, T_map_base);
    if (auto fault = surface_fault(world, config, region, T_map_base)) return unexpected(std::move(*fault));
    Truth truth{config.resolution_m,
                camera_truth(survey, config.camera, region, config.resolution_m, T_map_base),
                surface_truth(world, config, region, T_map_base)};
    if (!config.external_cameras.empty())
        truth.seen = seen_truth(world, config.external_cameras, config, T_map_base, truth.surface);
    return truth;
}

}  // namespace octoskin::evaluation
