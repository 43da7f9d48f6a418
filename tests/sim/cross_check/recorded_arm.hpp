// Some revolutions of an arm in a world without buses and boards, kept: what each sensor ranges with each
// image, also if its mount is turned, and what the camera predicts of it. Faults are then injected into what
// was kept, one sensor at a time, in milliseconds.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/core/beams/beam.hpp"
#include "host/core/cross_check/camera_judge.hpp"
#include "host/core/cross_check/cross_check.hpp"
#include "host/core/cross_check/range_predictor.hpp"

namespace octoskin::testing_support {

/// A sensor by its place in the rig: node by node, 0 .. 33.
using SensorNumber = std::size_t;

struct KeptRange {
    double range_m = 0.0;
    double noise_m = 0.0;  ///< what of that is noise
};

using JointPositions = std::array<double, kJointsMax>;

/// One reading of one sensor.
struct KeptReading {
    Beam beam;  ///< of the sound sensor, but for the range
    Eigen::Isometry3d T_map_sensor = Eigen::Isometry3d::Identity();
    JointTwists twists_map{};
    RangePredictions predictions;                         ///< if they are wanted
    std::optional<KeptRange> sound;                       ///< empty: it saw nothing, or the gate refuses it
    std::array<std::optional<KeptRange>, kTurns> turned;  ///< with its mount turned
};

/// What the camera showed, and where the rig has it: of all rigs the same.
struct KeptCamera {
    CameraIntrinsics intrinsics;
    double ray_slope_max = 0.0;
    Eigen::Isometry3d T_map_camera = Eigen::Isometry3d::Identity();
    std::vector<SeenImages> images;

    [[nodiscard]] CameraView view(std::size_t image) const;
};

struct KeptRun {
    HostRig rig;
    std::shared_ptr<const KeptCamera> camera;
    std::vector<BeamSource> sources;               ///< by sensor number
    std::vector<std::vector<KeptReading>> images;  ///< by image, by sensor number
    double images_hz = 10.0;
    double predicted_us_max = 0.0;  ///< the longest that one sensor's predictions took
    double predicted_us_mean = 0.0;
};

struct KeptChoice {
    std::uint64_t seed = 0;
    std::uint32_t revolutions = 3;
    bool has_turned = false;  ///< whether `turned` is wanted: nine times the work
    bool has_predictions = true;
    /// Below the source folder.
    std::string scenario = "hw/worlds/experiment.scenario.yaml";
    /// Where the true camera is and what it looks at, base frame, metres; empty: as the rig has it.
    std::optional<std::array<Eigen::Vector3d, 2>> camera_at_m = std::nullopt;
    /// What the rig says is the true pose without this, and the image's depth is the true one without it.
    CameraError camera_error = {};
    /// Of each joint, rad: what its joint states say is the true position less this.
    JointPositions joint_offset_rad = {};
};

/// Of each rig, of hw/rigs, with the same images. `pixel_divisor`: 1 is the rig's camera, 2 one of half as
/// many pixels a side, and so on; the image is then filtered with a window of 3 pixels instead of 5.
[[nodiscard]] std::vector<KeptRun> keep_runs(const std::vector<std::string>& rigs,
                                             std::uint32_t pixel_divisor, const KeptChoice& choice);

}  // namespace octoskin::testing_support
