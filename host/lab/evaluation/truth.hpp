// The two ground truths of one seed: the map of a noise-free camera, and the voxels that contain a surface of
// the world.
#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "common/result.hpp"
#include "host/lab/evaluation/seen.hpp"
#include "host/lab/evaluation/survey.hpp"
#include "host/lab/evaluation/truth_config.hpp"
#include "host/lab/evaluation/voxel_grid.hpp"
#include "hw/sim/world/world.hpp"

namespace octoskin::evaluation {

struct Truth {
    double resolution_m;
    VoxelGrid<Occupancy> camera;
    VoxelGrid<SurfaceVoxel> surface;  ///< over the same box
    /// Of the external cameras together; empty without one.
    std::optional<SeenTruth> seen = std::nullopt;

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

/// Why surface_truth() would take hours: the region has 1e9 surface points or more. Empty if it would not.
[[nodiscard]] std::optional<Error> surface_fault(const sim::World& world, const TruthConfig& config,
                                                 const KeyBox& region, const Eigen::Isometry3d& T_map_base);

/// Both truths for a world placed at `T_map_base` in the map. Error: surface_fault().
[[nodiscard]] Result<Truth, Error> build_truth(const sim::World& world, const Survey& survey,
                                               const TruthConfig& config,
                                               const Eigen::Isometry3d& T_map_base);

}  // namespace octoskin::evaluation
