// Places an accepted range at the pose of its sensor at the capture time. Rejects ranges that end on the
// robot itself.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "common/result.hpp"
#include "host/core/beams/beam.hpp"
#include "host/core/beams/range_measurement.hpp"
#include "host/core/beams/robot_pose.hpp"
#include "host/core/kinematics/robot_model.hpp"
#include "host/core/rig/host_rig.hpp"
#include "host/core/rig/sensor_id.hpp"

namespace octoskin {

struct BeamRules {
    bool removes_robot = true;
    /// A beam without target clears space up to this distance at most.
    double no_return_clear_m = 0.0;
    /// True: the self-hit test covers the sensor's whole cone. False: it covers the axis only, and beams have
    /// no optics.
    bool sees_cones = false;
};

enum class BeamFault : std::uint8_t {
    self_hit,    ///< beyond the predicted self-hit less the rig's margin; without return: nothing to clear
                 ///< before it
    unplaced,    ///< the position of a joint above the sensor is not known
    not_finite,  ///< the pose holds a NaN or an infinity
};

class BeamBuilder {
  public:
    /// Fails with the link's name if the robot does not have a link of the rig.
    [[nodiscard]] static Result<BeamBuilder, RobotModelFault> build(const HostRig& rig,
                                                                    const RobotModel& robot,
                                                                    const BeamRules& rules);

    /// Whether the rig has this zone of this sensor.
    [[nodiscard]] bool has(const BeamSource& source) const { return optics_of(source) != nullptr; }
    /// The optics of this zone's beams; null if the rig has no such zone.
    [[nodiscard]] const BeamOptics* optics_of(const BeamSource& source) const;

    /// `robot`: the pose at the capture time. The rig must have the source (asserted). About 50 ns per
    /// capsule.
    [[nodiscard]] Result<Beam, BeamFault> place(const RangeMeasurement& measurement,
                                                const RobotPose& robot) const;

    /// Pose of the source's sensor in the map frame. The rig must have the source (asserted).
    [[nodiscard]] Eigen::Isometry3d T_map_sensor(const BeamSource& source, const RobotPose& robot) const;
    /// How the sensor moves with each joint, map frame. `robot_model`: the model that the builder was built
    /// with.
    [[nodiscard]] JointTwists twists_map(const BeamSource& source, const RobotPose& robot,
                                         const RobotModel& robot_model) const;

  private:
    struct Zone {
        HostZone zone;
        /// The rays of the self-hit test, sensor frame: first the zone's direction, then those of its cone,
        /// if it has one.
        std::vector<Eigen::Vector3d> rays;
    };
    struct Sensor {
        LinkId link = 0;
        JointSet joints_above = 0;
        Eigen::Isometry3d T_link_sensor = Eigen::Isometry3d::Identity();
        std::vector<Zone> zones;
    };
    BeamBuilder() = default;
    /// Range in metres at which the zone meets the robot's own body; empty if it does not.
    [[nodiscard]] std::optional<double> self_hit(const Zone& zone, const Eigen::Isometry3d& T_base_sensor,
                                                 const RobotPose& robot) const;

    BeamRules rules_;
    double self_margin_m_ = 0.0;
    Eigen::Isometry3d T_map_base_ = Eigen::Isometry3d::Identity();
    std::vector<LinkId> ignored_links_;
    SensorTable<Sensor> sensors_;
};

}  // namespace octoskin
