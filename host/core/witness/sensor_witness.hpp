// Whether a range sensor contradicts the depth camera: two sensors exchanged at the harness, a pose in the
// rig that is not the true one, ranges that are off, a sensor that is stuck. I2C and CAN see none of these;
// the camera sees where things are, and where there is nothing.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <bitset>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/time.hpp"
#include "host/core/beams/beam.hpp"
#include "host/core/depth/depth_frame.hpp"
#include "host/core/rig/host_rig.hpp"
#include "host/core/witness/camera_view.hpp"
#include "host/core/witness/range_predictor.hpp"
#include "host/core/witness/sensor_judge.hpp"

namespace octoskin {

struct WitnessConfig {
    double camera_sigma_m = 0.03;  ///< of a pixel's depth
    bool is_filtered = true;       ///< the images are: what is left of it is about half
    /// How many of the comparisons that say anything contradict: of a sound sensor at the most, of one that
    /// is to be found at the least.
    double contradicted_sound = 0.02;
    double contradicted_faulty = 0.3;
    /// Of one test: that it flags a sound sensor, that it passes a faulty one (Wald 1945).
    double false_alarm = 1e-6;
    double missed = 1e-3;
};

enum class WitnessVerdict : std::uint8_t { agrees, contradicts, cannot_tell };

/// What the camera has said of a sensor so far.
struct SensorEvidence {
    std::uint64_t agreed = 0;          ///< it reported a surface where the camera sees one
    std::uint64_t in_free_space = 0;   ///< a surface where the camera sees through
    std::uint64_t behind_surface = 0;  ///< free space through a surface that the camera sees
    double log_likelihood_ratio = 0.0;
    bool is_far_off = false;  ///< the test of these has decided so, and none since has decided otherwise
    /// What the tests for single faults have found (SensorJudge), and how many ranges they had to do with.
    std::optional<SensorFault> fault = std::nullopt;
    std::optional<std::uint8_t> exchanged_with = std::nullopt;  ///< local index on its node
    std::uint64_t compared = 0;
    std::uint64_t fitted = 0;
    double evidence = 0.0;  ///< for the likeliest fault: log-likelihood ratio to a sound sensor

    /// Why it can neither be named nor be said to agree; empty with one of these.
    std::optional<SensorDoubt> doubt = SensorDoubt::too_few_comparisons;
    std::bitset<kSensorFaults> not_excluded =
        (1U << kSensorFaults) - 1U;  ///< by SensorFault; one that agrees may have faults that do not show

    [[nodiscard]] bool contradicts() const noexcept { return is_far_off || fault.has_value(); }
    [[nodiscard]] WitnessVerdict verdict() const noexcept {
        if (contradicts()) return WitnessVerdict::contradicts;
        return doubt ? WitnessVerdict::cannot_tell : WitnessVerdict::agrees;
    }
};

/// "camera: not where the rig has it ...", "joint panda_joint4: ...", "camera or joint panda_joint1: ..."
/// with what to do, for a person. `joints`: the rig's, in its order.
[[nodiscard]] std::string describe(const PoseFault& fault, std::span<const std::string> joints);

/// What the camera showed at one instant, all of its size. Their memory goes in and out.
struct SeenImages {
    DepthImage everything;             ///< filtered, with the robot in it
    DepthImage world;                  ///< without the robot
    std::vector<Certainty> certainty;  ///< by pixel
};

/// "contradicts the camera: ..." with what to do and the ranges that speak against it, for a person.
[[nodiscard]] std::string describe(const SensorEvidence& evidence);
/// "ranges_too_long", ...
[[nodiscard]] const char* name(SensorFault fault);
/// "too_few_comparisons", ...
[[nodiscard]] const char* name(SensorDoubt doubt);
/// "agrees", ...
[[nodiscard]] const char* name(WitnessVerdict verdict);

class SensorWitness {
  public:
    /// The rig must have a camera.
    SensorWitness(const HostRig& rig, const WitnessConfig& config);

    /// A beam, where its sensor was, and how that moves with each joint, map frame; the newest ones of each
    /// sensor are kept. Compares one of those that wait: 0.05 to 0.2 ms where there is one, else 0.1 us.
    void on_beam(const Beam& beam, const Eigen::Isometry3d& T_map_sensor, const JointTwists& twists_map = {});

    /// Images of the camera's size (asserted), seen from `T_map_camera`; what they are given for is some
    /// images of before. Each sensor's newest beam waits to be compared with them, if the two are of about
    /// the same time and the sensor has moved since it was last counted: what stands still says the same
    /// thing over and over. What has not been compared with the image before never will be. About 0.1 ms.
    void on_depth(SeenImages& images, const Eigen::Isometry3d& T_map_camera, HostTime captured);

    /// Compares all that still waits: up to 7 ms for 34 sensors.
    void settle();

    /// Time leapt: what waits to be compared is of another time. What was found out stays.
    void forget_beams();

    /// Of a sensor of the rig (asserted).
    [[nodiscard]] const SensorEvidence& evidence(std::uint8_t node_id, std::uint8_t sensor) const;

    /// How the camera, or a joint, is off, while that explains what several sensors contradict; then no
    /// sensor is named.
    [[nodiscard]] const PoseJudge& pose() const noexcept { return judge_.pose(); }

    /// Whether its readings are to be kept from the map: it contradicts the camera, and no fewer other
    /// sensors agree with it. Else it may be the camera.
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
        std::optional<Contradiction> first_contradiction;              ///< in the test that is not ended
        Eigen::Vector3d p_contradicted_map = Eigen::Vector3d::Zero();  ///< the newest one
        bool contradicts_elsewhere = false;                            ///< than at that
        bool found_far_off = false;  ///< by the test, whichever device may be off
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
                                                      const SensorJudge::Verdict& verdict,
                                                      std::optional<SensorDoubt> against_naming) const;
    void count(Sensor& sensor, const Beam& beam, Finding finding) const;
    [[nodiscard]] std::size_t index_of(std::uint8_t node_id, std::uint8_t sensor) const;

    WitnessConfig config_;
    CameraIntrinsics camera_;
    double ray_slope_max_;  ///< beyond, the lens's polynomial means nothing
    SensorTable<std::size_t> places_;
    std::vector<Sensor> sensors_;
    SensorJudge judge_;
    SeenImages images_;
    Eigen::Isometry3d T_map_camera_ = Eigen::Isometry3d::Identity();
    std::uint64_t image_count_ = 0;
    std::size_t next_ = 0;  ///< to be compared; sensors_.size(): none waits
    std::vector<Compared> compared_;
    std::size_t contradicting_ = 0;
    std::size_t agreeing_ = 0;
};

}  // namespace octoskin
