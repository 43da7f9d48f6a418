// Puts an accepted range where its sensor was at that instant, and refuses those that end on the robot
// itself.
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
    /// A beam without target clears space up to here at most.
    double no_return_clear_m = 0.0;
    /// Whether a sensor's cone counts: then the robot is looked for in all of it, else on its axis, and beams
    /// have no optics.
    bool sees_cones = false;
};

enum class BeamFault : std::uint8_t {
    self_hit,    ///< longer than the way to the robot's own body, less the rig's margin
    not_finite,  ///< the pose holds a NaN or an infinity
};

class BeamBuilder {
  public:
    /// Refuses, by name, a link of the rig that the robot does not have.
    [[nodiscard]] static Result<BeamBuilder, RobotModelFault> build(const HostRig& rig,
                                                                    const RobotModel& robot,
                                                                    const BeamRules& rules);

    /// Whether the rig has this zone of this sensor.
    [[nodiscard]] bool has(const BeamSource& source) const { return optics_of(source) != nullptr; }
    /// What its beams have; null where the rig has no such zone.
    [[nodiscard]] const BeamOptics* optics_of(const BeamSource& source) const;

    /// `robot`: at the capture time. The source must be one of the rig's (asserted). About 50 ns per capsule.
    [[nodiscard]] Result<Beam, BeamFault> place(const RangeMeasurement& measurement,
                                                const RobotPose& robot) const;

    /// Where the sensor of such a reading is, map frame. The source must be one of the rig's (asserted).
    [[nodiscard]] Eigen::Isometry3d T_map_sensor(const BeamSource& source, const RobotPose& robot) const;
    /// How that moves with each of the robot's joints, map frame. `robot_model`: the one it was built with.
    [[nodiscard]] JointTwists twists_map(const BeamSource& source, const RobotPose& robot,
                                         const RobotModel& robot_model) const;

  private:
    struct Zone {
        HostZone zone;
        /// What may meet the robot, sensor frame: the zone's direction first, then rays about it if it sees a
        /// cone.
        std::vector<Eigen::Vector3d> rays;
    };
    struct Sensor {
        LinkId link = 0;
        Eigen::Isometry3d T_link_sensor = Eigen::Isometry3d::Identity();
        std::vector<Zone> zones;
    };
    BeamBuilder() = default;
    /// How far the way is free of the robot.
    [[nodiscard]] std::optional<double> self_hit(const Zone& zone, const Eigen::Isometry3d& T_base_sensor,
                                                 const RobotPose& robot) const;

    BeamRules rules_;
    double self_margin_m_ = 0.0;
    Eigen::Isometry3d T_map_base_ = Eigen::Isometry3d::Identity();
    std::vector<LinkId> ignored_links_;
    SensorTable<Sensor> sensors_;
};

}  // namespace octoskin
