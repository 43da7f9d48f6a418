// What both ground truths are made from, and what they say of one voxel.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host/lab/evaluation/region.hpp"
#include "hw/rigfile/rig.hpp"

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
    /// Names of the SDF models that no external camera is supposed to see ("cone", "crate").
    std::vector<std::string> hidden_models;
    /// The external cameras of the rig at their true poses. They decide which voxels are occluded: those that
    /// none of them sees. Empty: all are.
    std::vector<rig::Camera> external_cameras;
    double surface_pitch_m = 0.008;
    /// A surface voxel is occluded if no voxel that a camera sees is within so many voxels (Chebyshev).
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
    bool is_seen : 1 = false;           ///< holds a point that an external camera sees
    bool is_occluded : 1 = false;       ///< a surface voxel further than the margin from every seen one
};

}  // namespace octoskin::evaluation
