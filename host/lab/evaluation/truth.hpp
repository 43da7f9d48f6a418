// The two ground truths of one seed: the map of a noise-free camera, and the voxels that contain a surface of
// the world.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "host/lab/evaluation/region.hpp"
#include "host/lab/evaluation/survey.hpp"
#include "host/lab/evaluation/voxel_grid.hpp"
#include "hw/rigfile/rig.hpp"
#include "hw/sim/world/world.hpp"

namespace octoskin::evaluation {

/// How the tour's views are mapped. The constants are OctoMap's, so that the ground truth does not depend on
/// the update under test.
struct CameraTruthConfig {
    float hit_log_odds = 0.85F;
    float miss_log_odds = -0.4F;
    float log_odds_min = -2.0F;
    float log_odds_max = 3.5F;
};

struct TruthConfig {
    double resolution_m = 0.04;
    RegionConfig region;
    CameraTruthConfig camera;
    /// Names of the SDF models that the external camera is not supposed to see ("cone", "crate").
    std::vector<std::string> hidden_models;
    /// The external camera of the rig at its true pose. It decides which voxels are occluded. Empty: all are.
    std::optional<rig::Camera> external_camera;
    double surface_pitch_m = 0.008;
    /// A surface voxel is occluded if no voxel that the camera sees is within so many voxels (Chebyshev).
    std::uint16_t occlusion_margin_voxels = 2;
    /// Distance to a surface that `precision_tolerant` accepts, in voxels (Chebyshev).
    std::uint16_t tolerance_voxels = 1;
};

/// Flags of one voxel by the analytic geometry.
struct SurfaceVoxel {
    bool is_surface : 1 = false;        ///< holds a point of a surface
    bool is_near_surface : 1 = false;   ///< itself or a neighbour within the tolerance does
    bool is_interior : 1 = false;       ///< centre inside a closed solid, no surface: not judged
    bool is_hidden_object : 1 = false;  ///< holds a point of a hidden model's surface
    bool is_seen : 1 = false;           ///< holds a point that the external camera sees
    bool is_occluded : 1 = false;       ///< a surface voxel further than the margin from every seen one
};

struct Truth {
    double resolution_m;
    VoxelGrid<Occupancy> camera;
    VoxelGrid<SurfaceVoxel> surface;  ///< over the same box

    [[nodiscard]] const KeyBox& region() const noexcept { return camera.box(); }
};

/// Occupied, free or unknown by the tour's camera. Each view adds one term to a voxel, a hit before a miss,
/// and the sum is clamped each time. Occupied: log-odds >= 0. Rays are traced as in OctoMap. O(points *
/// range).
[[nodiscard]] VoxelGrid<Occupancy> camera_truth(const Survey& survey, const CameraTruthConfig& config,
                                                const KeyBox& region, double resolution_m,
                                                const Eigen::Isometry3d& T_map_base);

/// The surface flags of every voxel of the region. Surfaces and seen points just outside the region, such as
/// the floor, count for the margins.
[[nodiscard]] VoxelGrid<SurfaceVoxel> surface_truth(const sim::World& world, const TruthConfig& config,
                                                    const KeyBox& region,
                                                    const Eigen::Isometry3d& T_map_base);

/// Both truths for a world placed at `T_map_base` in the map. Error: the region has 1e9 surface points or
/// more, which would take hours.
[[nodiscard]] Result<Truth, Error> build_truth(const sim::World& world, const Survey& survey,
                                               const TruthConfig& config,
                                               const Eigen::Isometry3d& T_map_base);

}  // namespace octoskin::evaluation
