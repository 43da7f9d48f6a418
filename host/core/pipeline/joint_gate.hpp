// Refuses joint samples that the arm cannot have: beyond the limits of the robot description, or unreachable
// from the sample before.
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

/// A joint sample beyond the limits of the robot description.
struct JointBeyond {
    std::size_t joint = 0;  ///< index in HostJointSource::joints of the sample's source
    double position = 0.0;  ///< radians or metres
    JointLimits limits;
    HostTime sampled;
};

class JointGate {
  public:
    /// `tolerance`: how far a sample may be beyond a limit, radians or metres.
    JointGate(std::span<const JointLimits> limits, double tolerance);

    /// Takes samples in the order of their times. Errors: out_of_limits, joint_jump, second_sender. A sample
    /// beyond the limits is not used as a start or an end of a motion. O(joints).
    [[nodiscard]] Status<JointReason> check(const JointMeasurement& joints);
    /// Resets the check: the next sample may be anywhere.
    void forget() { jump_.forget(); }

    /// The newest sample beyond its limits; empty if there was none.
    [[nodiscard]] const std::optional<JointBeyond>& beyond() const noexcept { return beyond_; }
    /// The check for samples that the arm cannot have reached.
    [[nodiscard]] const JointJump& jump() const noexcept { return jump_; }

  private:
    std::vector<JointLimits> limits_;
    double tolerance_;
    JointJump jump_;
    std::optional<JointBeyond> beyond_;
};

}  // namespace octoskin
