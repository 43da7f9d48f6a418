// Depth updates judged by what the camera sees, in a world without a robot.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "host/apps/recording/app_error.hpp"
#include "host/lab/depth_study/contender.hpp"
#include "host/lab/evaluation/free_calibration.hpp"
#include "host/lab/evaluation/seen.hpp"
#include "hw/rigfile/rig.hpp"
#include "hw/sim/scenario/scenario.hpp"
#include "hw/sim/world/world.hpp"

namespace octoskin::depth_study {

/// One camera's images of one noise and seed, which all contenders get.
struct DepthCase {
    const sim::World& world;
    const sim::Scenario& scenario;
    const rig::Camera& camera;
    Eigen::Isometry3d T_map_base;  ///< with the seed's shift
    const NamedNoise& noise;
    std::uint64_t seed = 0;
    const std::vector<Contender>& contenders;  ///< with voxels of one size
};

/// Whose figures they are.
struct Subject {
    std::string scenario;
    std::string noise;
    std::string configuration;
    double sigma_factor = 1.0;
    std::string label;  ///< Contender::label()
    std::uint64_t seed = 0;
};
[[nodiscard]] Subject subject_of(const DepthCase& of, const Contender& contender);

/// Figures of one contender's map at one time.
struct SeenFigures {
    Subject subject;
    double t_s = 0.0;  ///< of the last frame, from the first
    evaluation::SeenMetrics seen;
    evaluation::FreeCalibration free;  ///< of all surfaces of the region
};

/// The camera is stationary. Figures after the first frame at or after each time, in the order of times.
/// Errors: as DepthMapper::take() and evaluation::seen_truth() (bad_config).
[[nodiscard]] Result<std::vector<SeenFigures>, AppError> study_stationary(const DepthCase& of,
                                                                          const std::vector<double>& times_s);

/// The camera moves (circling()); each frame has its pose. Figures after the first frame, and after the first
/// at or after `end_s`, each by what the camera sees from there. Errors: likewise.
[[nodiscard]] Result<std::vector<SeenFigures>, AppError> study_moving(const DepthCase& of, double end_s);

}  // namespace octoskin::depth_study
