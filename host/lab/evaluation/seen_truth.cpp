#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <numbers>

#include "host/lab/evaluation/clean_view.hpp"
#include "host/lab/evaluation/seen.hpp"
#include "host/lab/evaluation/truth.hpp"

namespace octoskin::evaluation {
namespace {

constexpr double kCoarserBy_m = 0.002;
/// 90 degrees less the tilt of the outer spheres: then no centre is behind the seen point.
constexpr double kOutwardsMax_rad = 55.0 / 180.0 * std::numbers::pi;
/// Enough that a share has a standard error below 0.01.
constexpr std::size_t kClearSpheres = 3000;
/// Points at which they are tried. In the experiment one in 27 is clear: the camera sees the shelves' backs.
constexpr std::uint32_t kTriedSpheres = 100'000;

std::vector<Thickness> thicknesses_of(const sim::World& world) {
    std::vector<Thickness> all;
    for (const auto& solid : world.solids()) all.push_back(thickness_of(solid));
    return all;
}

/// The normal, turned towards the camera if it is further from it than kOutwardsMax_rad.
Eigen::Vector3d outwards(const Eigen::Vector3d& normal, const Eigen::Vector3d& to_camera) {
    const double along = normal.dot(to_camera);
    if (along >= std::cos(kOutwardsMax_rad)) return normal;
    const Eigen::Vector3d aside = (normal - along * to_camera).normalized();
    return std::cos(kOutwardsMax_rad) * to_camera + std::sin(kOutwardsMax_rad) * aside;
}

/// Width of a pixel on the surface, metres.
double footprint_m(const rig::Camera& camera, double depth_m) {
    return depth_m / std::min(camera.fx, camera.fy);
}

SeenVoxel seen_voxel(VoxelKey key, const ViewPoint& point, const Thickness& thickness,
                     const rig::Camera& camera, const Eigen::Isometry3d& T_map_base) {
    const Eigen::Vector3d to_camera = (camera.T_link_camera.translation() - point.p_base).normalized();
    const bool is_thinnest = thickness.of_class == ThicknessClass::rod_5_8_mm;
    return {.key = key,
            .thickness = thickness.of_class,
            .is_resolved =
                !is_thinnest || footprint_m(camera, point.depth_m) <= thickness.thickness_m + kCoarserBy_m,
            .p_map_point = T_map_base * point.p_base,
            .outwards_map = T_map_base.linear() * outwards(point.normal_base, to_camera),
            .to_camera_map = T_map_base.linear() * to_camera};
}

/// A voxel's point so far.
struct Chosen {
    const ViewPoint* point = nullptr;
    double thickness_m = -1.0;
    double off_centre_m = 0.0;

    /// A point of a thicker solid, or one nearer to the voxel's centre, is better.
    [[nodiscard]] bool is_worse_than(double other_thickness_m, double other_off_centre_m) const {
        if (other_thickness_m != thickness_m) return other_thickness_m > thickness_m;
        return other_off_centre_m < off_centre_m;
    }
    void offer(const ViewPoint& other, double other_thickness_m, double other_off_centre_m) {
        if (is_worse_than(other_thickness_m, other_off_centre_m))
            *this = {&other, other_thickness_m, other_off_centre_m};
    }
};

/// Of one view, by index in the region: an image sees a small part of it.
std::map<std::size_t, Chosen> chosen_points(const CleanView& view, std::span<const Thickness> thicknesses,
                                            const KeyBox& region, const VoxelLattice& lattice,
                                            const Eigen::Isometry3d& T_map_base) {
    std::map<std::size_t, Chosen> chosen;
    for (const ViewPoint& point : view.points()) {
        const Eigen::Vector3d p_map = T_map_base * point.p_base;
        const auto key = lattice.key_of(p_map);
        if (!key || !region.contains(*key)) continue;
        chosen[region.index_of(*key)].offer(point, thicknesses[point.solid].thickness_m,
                                            (p_map - lattice.centre_of(*key)).norm());
    }
    return chosen;
}

/// A voxel with the values of its point that make it the better of two cameras' ones.
struct Judged {
    SeenVoxel voxel;
    Chosen chosen;

    /// The same voxel as another camera sees it. Resolved by either camera is resolved.
    void add(const Judged& other) {
        const bool is_one_solid = chosen.thickness_m == other.chosen.thickness_m;
        const bool is_resolved = is_one_solid && (voxel.is_resolved || other.voxel.is_resolved);
        if (chosen.is_worse_than(other.chosen.thickness_m, other.chosen.off_centre_m)) *this = other;
        voxel.is_resolved |= is_resolved;
    }
};

/// The voxels that any of the cameras sees; `views`: theirs.
std::vector<SeenVoxel> seen_voxels(std::span<const CleanView> views, const sim::World& world,
                                   std::span<const rig::Camera> cameras, const KeyBox& region,
                                   const VoxelLattice& lattice, const Eigen::Isometry3d& T_map_base) {
    const auto thicknesses = thicknesses_of(world);
    std::map<std::size_t, Judged> judged;
    for (std::size_t i = 0; i < views.size(); ++i) {
        for (const auto& [index, chosen] :
             chosen_points(views[i], thicknesses, region, lattice, T_map_base)) {
            const Judged seen{seen_voxel(region.key_at(index), *chosen.point,
                                         thicknesses[chosen.point->solid], cameras[i], T_map_base),
                              chosen};
            if (const auto [known, is_new] = judged.try_emplace(index, seen); !is_new)
                known->second.add(seen);
        }
    }
    std::vector<SeenVoxel> voxels;
    voxels.reserve(judged.size());
    for (const auto& [index, seen] : judged) voxels.push_back(seen.voxel);
    return voxels;
}

/// Points that fill the unit cube evenly in any number, without randomness: multiples of the powers of 1 / g,
/// g the root of g^4 = g + 1 (Roberts 2018, "The unreasonable effectiveness of quasirandom sequences").
Eigen::Vector3d even_point(std::uint32_t index) {
    constexpr double kRoot = 1.2207440846057596;
    const Eigen::Vector3d step(1.0 / kRoot, 1.0 / (kRoot * kRoot), 1.0 / (kRoot * kRoot * kRoot));
    const Eigen::Vector3d point = Eigen::Vector3d::Constant(0.5) + (index + 1.0) * step;
    return point - point.array().floor().matrix();
}

/// Clear for any of the cameras. All voxels that a sphere overlaps are in the region.
std::vector<Eigen::Vector3d> clear_spheres(std::span<const CleanView> views, const KeyBox& region,
                                           const VoxelLattice& lattice, const Eigen::Isometry3d& T_map_base) {
    const Eigen::Vector3d margin = Eigen::Vector3d::Constant(kClearRadius_m - lattice.resolution_m() / 2.0);
    const Eigen::Vector3d low = lattice.centre_of(region.min) + margin;
    const Eigen::Vector3d size = lattice.centre_of(region.max) - margin - low;
    std::vector<Eigen::Vector3d> spheres;
    if (size.minCoeff() < 0.0) return spheres;
    const Eigen::Isometry3d T_base_map = T_map_base.inverse();
    for (std::uint32_t i = 0; i < kTriedSpheres && spheres.size() < kClearSpheres; ++i) {
        const Eigen::Vector3d p_map = low + even_point(i).cwiseProduct(size);
        const auto is_clear = [p_base = Eigen::Vector3d(T_base_map * p_map)](const CleanView& view) {
            return view.is_clear(p_base, kClearRadius_m + kClearance_m);
        };
        if (std::ranges::any_of(views, is_clear)) spheres.push_back(p_map);
    }
    return spheres;
}

std::optional<double> f1_of_seen(const std::vector<SeenVoxel>& voxels,
                                 const VoxelGrid<SurfaceVoxel>& surface) {
    std::uint64_t marked = 0;
    std::uint64_t right = 0;
    for (const SeenVoxel& voxel : voxels) {
        const SurfaceVoxel& truth = surface.at(voxel.key);
        marked += truth.is_interior ? 0U : 1U;
        right += truth.is_surface ? 1U : 0U;
    }
    std::uint64_t all = 0;
    for (std::size_t i = 0; i < surface.size(); ++i) all += surface[i].is_surface ? 1U : 0U;
    if (marked + all == 0) return std::nullopt;
    return 2.0 * static_cast<double>(right) / static_cast<double>(marked + all);
}

}  // namespace

Result<SeenTruth, Error> seen_truth(const sim::World& world, std::span<const rig::Camera> cameras,
                                    const TruthConfig& config, const Eigen::Isometry3d& T_map_base) {
    if (auto fault = region_fault(config.region, config.resolution_m, T_map_base))
        return unexpected(std::move(*fault));
    const KeyBox region = region_of(config.region, config.resolution_m, T_map_base);
    if (auto fault = surface_fault(world, config, region, T_map_base)) return unexpected(std::move(*fault));
    TruthConfig without_camera = config;
    without_camera.external_cameras.clear();
    return seen_truth(world, cameras, config, T_map_base,
                      surface_truth(world, without_camera, region, T_map_base));
}

SeenTruth seen_truth(const sim::World& world, std::span<const rig::Camera> cameras, const TruthConfig& config,
                     const Eigen::Isometry3d& T_map_base, VoxelGrid<SurfaceVoxel> surface) {
    const KeyBox region = surface.box();
    assert(region == region_of(config.region, config.resolution_m, T_map_base));
    const VoxelLattice lattice(config.resolution_m);
    std::vector<CleanView> views;
    for (const rig::Camera& camera : cameras) views.emplace_back(world, camera);
    auto voxels = seen_voxels(views, world, cameras, region, lattice, T_map_base);
    const auto f1 = f1_of_seen(voxels, surface);
    return {.resolution_m = config.resolution_m,
            .surface = std::move(surface),
            .voxels = std::move(voxels),
            .p_map_clear_spheres = clear_spheres(views, region, lattice, T_map_base),
            .f1_noise_free = f1};
}

}  // namespace octoskin::evaluation
