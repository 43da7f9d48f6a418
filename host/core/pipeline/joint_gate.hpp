// Which joint samples the arm can have taken: within the limits of the robot description, and reachable from
// the sample before.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "common/result.hpp"
#include "common/time.hpp"
#include "host/core/ingest/can_intake.hpp"
#include "host/core/ingest/reasons.hpp"
#include "host/core/kinematics/joint_jump.hpp"
#include "host/core/kinematics/robot_model.hpp"

namespace octoskin {

/// A joint sample that is beyond the limits of the robot description.
struct JointBeyond {
    std::size_t joint = 0;  ///< of HostJoints::joints
    double position = 0.0;  ///< radians or metres
    JointLimits limits;
    HostTime sampled;
};

class JointGate {
  public:
    /// `tolerance`: so far beyond a limit a sample may be, radians or metres.
    JointGate(std::span<const JointLimits> limits, double tolerance);

    /// Samples in the order of their times. Errors: out_of_limits, joint_jump, second_sender. What is beyond
    /// the limits is nowhere that the arm could have moved to or from. O(joints).
    [[nodiscard]] Status<JointReason> check(const JointMeasurement& joints);
    /// What comes next may be anywhere.
    void forget() { jump_.forget(); }

    /// The newest sample beyond its limits; empty if none was.
    [[nodiscard]] const std::optional<JointBeyond>& beyond() const noexcept { return beyond_; }
    /// Which samples the arm cannot have moved to.
    [[nodiscard]] const JointJump& jump() const noexcept { return jump_; }

  private:
    std::vector<JointLimits> limits_;
    double tolerance_;
    JointJump jump_;
    std::optional<JointBeyond> beyond_;
};

}  // namespace octoskin
