// The scripted motion of the arm: joint positions at any instant.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "hw/sim/arm/arm.hpp"
#include "hw/sim/vl53l1x/scene.hpp"

namespace octoskin::sim {

/// A link moved round a circle at constant speed and orientation, base frame, metres. At angle a the link's
/// origin is at p_base_centre + radius_m (cos a towards_start + sin a towards_quarter).
struct CircleMotion {
    std::string link;
    Eigen::Vector3d p_base_centre = Eigen::Vector3d::Zero();
    double radius_m = 0.0;
    Eigen::Vector3d towards_start = Eigen::Vector3d::UnitX();  ///< unit; where the motion starts
    Eigen::Vector3d towards_quarter =
        Eigen::Vector3d::UnitY();  ///< unit, at right angles; a quarter turn later
    Eigen::Matrix3d R_base_link = Eigen::Matrix3d::Identity();
    std::uint32_t ticks_per_revolution = 0;
    std::uint32_t revolutions = 1;
    double tick_rate_hz = 0.0;
    Eigen::VectorXd start_position;  ///< where the inverse kinematics of the first tick starts, radians

    /// Where the link is to be at a tick, 0 .. ticks().
    [[nodiscard]] Eigen::Isometry3d T_base_link(std::uint32_t tick) const;
    [[nodiscard]] std::uint32_t ticks() const noexcept { return ticks_per_revolution * revolutions; }
};

/// Joint positions at rest before the motion, through the inverse kinematics of each tick during it, and at
/// rest after it. Between two ticks each joint moves at constant speed: on the experiment's circle the link
/// then deviates from the arc by 16 um.
class Trajectory {
  public:
    /// Solves every tick from the one before. Errors, with the scenario's key but without its file: no such
    /// link; a tick out of reach (residual over 2e-7 m or rad); a joint outside its limits; each with the
    /// tick. About 10 ms for 300 ticks.
    [[nodiscard]] static Result<Trajectory, Error> circle(const Arm& arm, const CircleMotion& motion,
                                                          SimTime start);

    /// N joints, radians, continuous in time. < 1 us.
    [[nodiscard]] Eigen::VectorXd at(SimTime time) const;
    [[nodiscard]] SimTime start() const noexcept { return start_; }
    [[nodiscard]] SimTime end() const noexcept;

  private:
    Trajectory(SimTime start, double tick_rate_hz) : start_(start), tick_rate_hz_(tick_rate_hz) {}

    SimTime start_;
    double tick_rate_hz_;
    std::vector<Eigen::VectorXd> ticks_;
};

}  // namespace octoskin::sim
