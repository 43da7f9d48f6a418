// What a map says of the surfaces and of the space that cameras see: occupied, free or unknown, by
// thickness of the solids, and where a planner would drive. docs/reference/evaluation.md has the domain of
// each figure.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/result.hpp"
#include "host/core/mapping/fused_map.hpp"
#include "host/lab/evaluation/thickness.hpp"
#include "host/lab/evaluation/truth_config.hpp"
#include "host/lab/evaluation/voxel_grid.hpp"
#include "hw/rigfile/rig.hpp"
#include "hw/sim/world/world.hpp"

namespace octoskin::evaluation {

/// A voxel that holds a point of a surface that a camera sees.
struct SeenVoxel {
    VoxelKey key;
    ThicknessClass thickness = ThicknessClass::other;  ///< of the thickest solid that is seen in it
    /// The pixels of a camera that sees it are fine enough for the class: always, except that a rod of 5 to 8
    /// mm needs a footprint of at most its thickness + 2 mm.
    bool is_resolved = true;
    /// The seen point of that solid that is nearest to the voxel's centre, map frame, metres.
    Eigen::Vector3d p_map_point = Eigen::Vector3d::Zero();
    /// Out of the surface; at most 55 degrees from the direction to the camera. Unit, map frame.
    Eigen::Vector3d outwards_map = Eigen::Vector3d::UnitZ();
    Eigen::Vector3d to_camera_map = Eigen::Vector3d::UnitZ();  ///< that sees the point; unit, map frame
};

/// The surfaces and the empty space of a world that cameras see from where they stand, on one map grid: what
/// any of them sees is seen.
struct SeenTruth {
    double resolution_m = 0.0;
    VoxelGrid<SurfaceVoxel> surface;  ///< of the region; what it says of a camera is not used
    std::vector<SeenVoxel> voxels;    ///< by index in the region
    /// Centres of spheres of 5 cm in space that one camera sees, 4 cm clear of all that it sees; map frame.
    std::vector<Eigen::Vector3d> p_map_clear_spheres;
    /// F1 (as Metrics::f1) of a map that has exactly the seen voxels as occupied. Empty without surfaces.
    std::optional<double> f1_noise_free;

    [[nodiscard]] const KeyBox& region() const noexcept { return surface.box(); }
};

/// `cameras`: each at its T_base_camera, noise-free, every pixel. `config`: region, resolution, surfaces; its
/// external cameras are not used. The robot is not in it. Errors: region_fault(), surface_fault(). About 0.2
/// s for the experiment.
[[nodiscard]] Result<SeenTruth, Error> seen_truth(const sim::World& world,
                                                  std::span<const rig::Camera> cameras,
                                                  const TruthConfig& config,
                                                  const Eigen::Isometry3d& T_map_base);
/// The same with the surfaces of surface_truth() over the region of `config`, which take most of the time.
[[nodiscard]] SeenTruth seen_truth(const sim::World& world, std::span<const rig::Camera> cameras,
                                   const TruthConfig& config, const Eigen::Isometry3d& T_map_base,
                                   VoxelGrid<SurfaceVoxel> surface);

/// Radii of the spheres of the body tests, metres.
inline constexpr std::array<double, 2> kBodyRadii_m{0.02, 0.05};
/// Depth of a seen point in the spheres that test its voxel.
inline constexpr double kBodyOverlap_m = 0.01;
/// Radius of the spheres in seen empty space, and their distance to all surfaces.
inline constexpr double kClearRadius_m = 0.05;
inline constexpr double kClearance_m = 0.04;

/// The four spheres of one radius that test a voxel: centres in the map frame. Each holds the seen point 1 cm
/// deep, and no centre is further from the camera than the point. One lies along `outwards_map`, three are
/// tilted by 35 degrees from it, the first of them towards the camera.
[[nodiscard]] std::array<Eigen::Vector3d, 4> body_centres(const SeenVoxel& voxel, double radius_m);

/// Spheres that overlap a seen surface.
struct BodyTests {
    std::uint64_t spheres = 0;
    std::uint64_t free = 0;  ///< all voxels that the sphere overlaps are free: a planner would drive there

    [[nodiscard]] std::optional<double> free_share() const noexcept;
};

/// Seen voxels by their state in a map.
struct SeenShares {
    std::uint64_t voxels = 0;  ///< the sum of the next three
    std::uint64_t occupied = 0;
    std::uint64_t free = 0;
    std::uint64_t unknown = 0;
    BodyTests body_2cm;
    BodyTests body_5cm;

    // Of `voxels`; empty without any.
    [[nodiscard]] std::optional<double> occupied_share() const noexcept;
    [[nodiscard]] std::optional<double> free_share() const noexcept;
    [[nodiscard]] std::optional<double> unknown_share() const noexcept;
    void add(const SeenShares& other) noexcept;
};
/// In the order of ThicknessClass.
using SharesByClass = std::array<SeenShares, kThicknessClasses>;

/// Ratios are empty where the denominator is 0.
struct SeenMetrics {
    SeenShares all;
    SharesByClass by_class;  ///< without the next
    /// Seen voxels of rods of 5 to 8 mm that all pixels are too coarse for: in `all` only.
    SeenShares too_coarse;

    std::optional<double> seen_occupied;  ///< share of `all`, as the next two
    std::optional<double> seen_free;
    std::optional<double> seen_unknown;
    std::optional<double> precision;           ///< as Metrics::precision
    std::optional<double> precision_tolerant;  ///< as Metrics::precision_tolerant
    std::optional<double> f1_seen;        ///< of precision and seen_occupied; a noise-free image has 1.00
    std::optional<double> f1_noise_free;  ///< the truth's: what a perfect image has as Metrics::f1
    std::optional<double> body_2cm;       ///< share of `all`'s spheres that are free
    std::optional<double> body_5cm;

    std::uint64_t clear_spheres = 0;
    std::uint64_t clear_spheres_free = 0;    ///< all voxels that the sphere overlaps are free
    std::optional<double> availability_5cm;  ///< share of them
};

/// The resolutions must be equal (asserted). The states of voxels beside the region, which a sphere may
/// overlap, are the map's too. About 10 ms for the experiment.
[[nodiscard]] SeenMetrics seen_metrics(const FusedMap& map, const SeenTruth& truth);

}  // namespace octoskin::evaluation
