// The judged region: the part of the map that is compared with the ground truth.
#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "host/errors/error.hpp"
#include "host/lab/evaluation/voxel_grid.hpp"

namespace octoskin::evaluation {

/// A box in the map frame, and the floor that bounds it from below.
struct RegionConfig {
    Eigen::Vector3d p_map_min{-0.6, -1.2, -0.2};
    Eigen::Vector3d p_map_max{1.4, 1.2, 1.4};
    /// Height of the floor's top in the world frame, metres. The region begins one layer above the layer that
    /// holds it: every sensor sees the floor, and its voxels would dominate the figures. Empty: no floor.
    std::optional<double> floor_top_m = -0.02;
};

/// Why the box cannot be judged at this resolution; empty if it can. Reasons: no voxel above the floor, a box
/// outside the map's keys, or more than 50 million voxels (too slow).
[[nodiscard]] std::optional<Error> region_fault(const RegionConfig& config, double resolution_m,
                                                const Eigen::Isometry3d& T_map_base);

/// The voxels whose centres lie in the box and whose layer is above the floor's. `T_map_base` transforms the
/// world into the map frame. `region_fault` must return empty (asserted).
[[nodiscard]] KeyBox region_of(const RegionConfig& config, double resolution_m,
                               const Eigen::Isometry3d& T_map_base);

/// The layer (z of a voxel key) that holds the floor's top.
[[nodiscard]] std::uint16_t floor_layer(double floor_top_m, double resolution_m,
                                        const Eigen::Isometry3d& T_map_base);

}  // namespace octoskin::evaluation
