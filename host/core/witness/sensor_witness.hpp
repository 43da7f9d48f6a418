// Whether a range sensor contradicts the depth camera: two sensors swapped at the harness, a pose in the rig
// that is not the true one, a sensor that is stuck. I2C and CAN see none of these; the camera sees where
// there is nothing.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "common/time.hpp"
#include "host/core/beams/beam.hpp"
#include "host/core/depth/depth_frame.hpp"
#include "host/core/rig/host_rig.hpp"

namespace octoskin {

struct WitnessConfig {
    double camera_sigma_m = 0.03;  ///< of a pixel's depth
    /// How many of the comparisons that say anything contradict: of a sound sensor at the most, of one that
    /// is to be found at the least.
    double contradicted_sound = 0.02;
    double contradicted_faulty = 0.3;
    /// Of one test: that it flags a sound sensor, that it passes a faulty one (Wald 1945).
    double false_alarm = 1e-6;
    double missed = 1e-3;
};

/// What the camera has said of a sensor so far.
struct SensorEvidence {
    std::uint64_t agreed = 0;          ///< it reported a surface where the camera sees one
    std::uint64_t in_free_space = 0;   ///< a surface where the camera sees through
    std::uint64_t behind_surface = 0;  ///< free space through a surface that the camera sees
    double log_likelihood_ratio = 0.0;
    bool contradicts = false;  ///< the test has decided so, and none since has decided otherwise
};

/// "contradicts the camera (...): ..." with the counts, for a person.
[[nodiscard]] std::string describe(const SensorEvidence& evidence);

/// What the camera sees at one instant. Both of its size.
struct WitnessImages {
    const DepthImage& everything;  ///< as it came, filtered: in front of the robot, too, it sees through
    const DepthImage& world;       ///< without the robot
};

class SensorWitness {
  public:
    /// The rig must have a camera.
    SensorWitness(const HostRig& rig, const WitnessConfig& config);

    /// A beam that went into the map; the newest of each sensor is kept. About 0.1 us.
    void on_beam(const Beam& beam);

    /// Images of the camera's size (asserted), seen from `T_map_camera`. Compares each sensor's
    /// newest beam with it, if the two are of about the same time and the sensor has moved since it was last
    /// counted: what stands still says the same thing over and over. At most one beam a sensor, 19 rays a
    /// beam, 134 pixels a ray: for 34 sensors 0.1 ms as a rule, and bounded whatever the bus does.
    void on_depth(const WitnessImages& images, const Eigen::Isometry3d& T_map_camera, HostTime captured);

    /// Time leapt: what waits to be compared is of another time. What was found out stays.
    void forget_beams();

    /// Of a sensor of the rig (asserted).
    [[nodiscard]] const SensorEvidence& evidence(std::uint8_t node_id, std::uint8_t sensor) const;

  private:
    struct Sensor {
        std::optional<Beam> newest;
        std::optional<Beam> counted;
        SensorEvidence evidence;
    };
    enum class Finding : std::uint8_t { nothing, agrees, in_free_space, behind_surface };
    class View;

    [[nodiscard]] Finding compare(const Beam& beam, const View& everything, const View& world) const;
    void count(Sensor& sensor, Finding finding) const;

    WitnessConfig config_;
    CameraIntrinsics camera_;
    double ray_slope_max_;  ///< beyond, the lens's polynomial means nothing
    std::map<std::pair<std::uint8_t, std::uint8_t>, Sensor> sensors_;  ///< by node and local index
};

}  // namespace octoskin
