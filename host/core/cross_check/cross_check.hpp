// Cross-check of the range sensors against one depth camera. Finds two sensors exchanged at the harness, a
// wrong pose in the rig, ranges with an offset, and a stuck sensor. None of these shows on I2C or CAN, but
// the camera shows surfaces and free space.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <bitset>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/time.hpp"
#include "host/core/beams/beam.hpp"
#include "host/core/cross_check/camera_view.hpp"
#include "host/core/cross_check/range_predictor.hpp"
#include "host/core/cross_check/sensor_judge.hpp"
#include "host/core/depth/depth_frame.hpp"
#include "host/core/rig/host_rig.hpp"

namespace octoskin {

struct CrossCheckConfig {
    double camera_sigma_m = 0.03;  ///< standard deviation of a pixel's depth
    bool is_filtered = true;       ///< the images are filtered, which about halves `camera_sigma_m`
    /// Share of contradictions among the informative comparisons: the maximum for a healthy sensor, and the
    /// minimum for a faulty one.
    double contradicted_sound = 0.02;
    double contradicted_faulty = 0.3;
    /// Probabilities of one test: of flagging a healthy sensor, and of clearing a faulty one (Wald 1945).
    double false_alarm = 1e-6;
    double missed = 1e-3;
};

enum class CrossCheckFinding : std::uint8_t { agrees, contradicts, cannot_tell };

/// The camera's evidence about a sensor so far.
struct SensorEvidence {
    std::uint64_t agreed = 0;          ///< reported a surface where the camera sees one
    std::uint64_t in_free_space = 0;   ///< reported a surface where the camera sees free space
    std::uint64_t behind_surface = 0;  ///< reported free space through a surface that the camera sees
    double log_likelihood_ratio = 0.0;
    bool is_far_off = false;  ///< large errors, by the test of these counts; no later test has cleared it
    /// Results of the tests for single faults (SensorJudge). `compared`: number of ranges used; `fitted`:
    /// number of those that fit the rig.
    std::optional<RangeFault> fault = std::nullopt;
    std::optional<std::uint8_t> exchanged_with = std::nullopt;  ///< local index on its node
    std::uint64_t compared = 0;
    std::uint64_t fitted = 0;
    double evidence = 0.0;  ///< for the most likely fault: log-likelihood ratio to a healthy sensor

    /// Why it can neither be reported nor be said to agree; empty if one of the two applies.
    std::optional<SensorDoubt> doubt = SensorDoubt::too_few_comparisons;
    /// Indexed by RangeFault. A sensor that agrees may still have faults that do not show.
    std::bitset<kRangeFaults> not_excluded = (1U << kRangeFaults) - 1U;

    [[nodiscard]] bool contradicts() const noexcept { return is_far_off || fault.has_value(); }
    [[nodiscard]] CrossCheckFinding verdict() const noexcept {
        if (contradicts()) return CrossCheckFinding::contradicts;
        return doubt ? CrossCheckFinding::cannot_tell : CrossCheckFinding::agrees;
    }
};

/// "camera: its pose in the rig or its depth scale is wrong: ...", "joint panda_joint4: ...", "camera or
/// joint panda_joint1: ..." with the remedy, for people. `joints`: the rig's, in its order. `camera`: the
/// name of the camera, if the rig has several.
[[nodiscard]] std::string describe(const PoseFault& fault, std::span<const std::string> joints,
                                   std::string_view camera = {});

/// Images of one instant, all of the same size. Their memory is swapped in and out.
struct SeenImages {
    DepthImage everything;             ///< filtered, with the robot
    DepthImage world;                  ///< without the robot
    std::vector<Certainty> certainty;  ///< by pixel
};

/// "contradicts the camera: ..." with the remedy and the number of contradicting ranges, for people.
/// `camera`: the name of the camera, if the rig has several.
[[nodiscard]] std::string describe(const SensorEvidence& evidence, std::string_view camera = {});
/// "ranges_too_long", ...
[[nodiscard]] const char* name(RangeFault fault);
/// "too_few_comparisons", ...
[[nodiscard]] const char* name(SensorDoubt doubt);
/// "agrees", ...
[[nodiscard]] const char* name(CrossCheckFinding verdict);

class CrossCheck {
  public:
    /// Against the rig's camera with this index (asserted).
    CrossCheck(const HostRig& rig, const CrossCheckConfig& config, std::size_t camera = 0);

    /// A beam with its sensor's pose and motion with each joint, map frame. The newest ones of each sensor
    /// are stored. Compares one waiting beam: 0.05 to 0.2 ms if there is one, otherwise 0.1 us.
    void on_beam(const Beam& beam, const Eigen::Isometry3d& T_map_sensor, const JointTwists& twists_map = {});

    /// Images of the camera's size (asserted), seen from `T_map_camera`; swapped for earlier images. Each
    /// sensor's newest beam waits for comparison with them if both are of about the same time, and the sensor
    /// has moved since it was last counted: a stationary sensor repeats the same evidence. Beams not yet
    /// compared with the previous image are dropped. About 0.1 ms.
    void on_depth(SeenImages& images, const Eigen::Isometry3d& T_map_camera, HostTime captured);

    /// Compares all waiting beams: up to 7 ms for 34 sensors.
    void settle();

    /// Time jump: drops waiting beams, which are from another time. Results stay.
    void forget_beams();

    /// The evidence about a sensor of the rig (asserted).
    [[nodiscard]] const SensorEvidence& evidence(std::uint8_t node_id, std::uint8_t sensor) const;

    /// The error of the camera or of a joint, while it explains the contradictions of several sensors; no
    /// sensor is reported then.
    [[nodiscard]] const PoseJudge& pose() const noexcept { return judge_.pose(); }

    /// True if the sensor's readings are to be refused: it contradicts the camera, and at least as many
    /// sensors agree with the camera as contradict it. Otherwise, the camera may be the cause.
    [[nodiscard]] bool is_to_be_refused(std::uint8_t node_id, std::uint8_t sensor) const;

  private:
    struct Placed {
        Beam beam;
        Eigen::Isometry3d T_map_sensor;
        JointTwists twists_map;
    };
    struct Contradiction {
        HostTime captured;
        Eigen::Vector3d p_map;  ///< where the range ended
    };
    struct Sensor {
        std::vector<RangePredictor> predictors;  ///< by zone
        std::vector<BeamOptics> optics;
        std::array<std::optional<Placed>, 3> newest;  ///< the newest first
        std::optional<Placed> waiting;
        std::optional<Beam> counted;
        std::optional<Contradiction> first_contradiction;              ///< in the current test
        Eigen::Vector3d p_contradicted_map = Eigen::Vector3d::Zero();  ///< the newest contradiction
        bool contradicts_elsewhere = false;  ///< at another place than the first contradiction
        bool found_far_off = false;          ///< by the test, whichever device is the cause
        SensorEvidence evidence;
        bool contradicted = false;  ///< after the newest image
    };
    enum class Finding : std::uint8_t { nothing, agrees, in_free_space, behind_surface };

    [[nodiscard]] CameraView view() const;
    void go_to_waiting();
    void compare_next();
    void judge();
    [[nodiscard]] Finding compare(const Beam& beam, const BeamOptics& optics, const CameraView& view) const;
    [[nodiscard]] std::optional<SensorDoubt> doubt_of(const Sensor& sensor,
                                                      const SensorJudge::SensorFinding& verdict,
                                                      std::optional<SensorDoubt> against_naming) const;
    void count(Sensor& sensor, const Beam& beam, Finding finding) const;
    [[nodiscard]] std::size_t index_of(std::uint8_t node_id, std::uint8_t sensor) const;

    CrossCheckConfig config_;
    CameraIntrinsics camera_;
    double ray_slope_max_;  ///< the lens's polynomial is invalid beyond it
    SensorTable<std::size_t> places_;
    std::vector<Sensor> sensors_;
    SensorJudge judge_;
    SeenImages images_;
    Eigen::Isometry3d T_map_camera_ = Eigen::Isometry3d::Identity();
    std::uint64_t image_count_ = 0;
    std::size_t next_ = 0;  ///< the next to compare; sensors_.size(): none waits
    std::vector<Compared> compared_;
    std::size_t contradicting_ = 0;
    std::size_t agreeing_ = 0;
};

}  // namespace octoskin
