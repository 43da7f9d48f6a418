// Decides whether an offset of one joint from its joint states explains the contradictions of range sensors.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "host/core/cross_check/error_fit.hpp"
#include "host/core/cross_check/range_change.hpp"
#include "host/core/kinematics/joint_twist.hpp"

namespace octoskin {

/// A joint and its offset from its joint states: radians, or metres of a prismatic joint.
struct JointError {
    std::size_t joint = 0;
    double offset = 0.0;
};

/// CameraJudge's estimate with one unknown: for each joint alone its offset, from the ranges of all sensors
/// that the joint carries. Uses about the newest 1500 comparisons. 0.1 kB for each sensor and joint.
class JointJudge {
  public:
    /// `joints`: of the robot, at most kJointsMax.
    JointJudge(std::size_t sensors, std::size_t joints) : sensors_(sensors, std::vector<Fit>(joints)) {}

    /// `twists`: motion of the sensor with each joint, camera coordinates. About 1 us for seven joints.
    void compare(std::uint16_t sensor, const RangeChange& change, const JointTwists& twists);
    /// Call after all comparisons with one image. About 10 us for 34 sensors.
    void decide();

    /// The error of the most likely joint, while at least two sensors support it, and all sensors except the
    /// strongest supporter support it by a likelihood ratio of e^4.5.
    [[nodiscard]] const std::optional<JointError>& error() const noexcept { return error_; }
    /// True if an error is so likely that no sensor may be reported. One unknown fits less of the general
    /// deviations than the camera's seven, so the limit is lower.
    [[nodiscard]] bool is_suspect() const { return evidence_.is_suspect(1.75); }
    /// The most likely joint, even if its error is not significant.
    [[nodiscard]] const JointError& likeliest() const noexcept { return likeliest_; }
    /// The evidence for the most likely error.
    [[nodiscard]] const ErrorEvidence& evidence() const noexcept { return evidence_; }

  private:
    using Fit = ErrorFit<1>;
    std::vector<std::vector<Fit>> sensors_;  ///< for each joint
    std::optional<JointError> error_;
    JointError likeliest_;
    ErrorEvidence evidence_;
};

}  // namespace octoskin
