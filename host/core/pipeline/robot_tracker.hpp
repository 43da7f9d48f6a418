// Computes the pose of the whole robot at any instant from joint samples.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "common/result.hpp"
#include "common/time.hpp"
#include "host/core/beams/robot_pose.hpp"
#include "host/core/ingest/can_intake.hpp"
#include "host/core/kinematics/joint_history.hpp"
#include "host/core/kinematics/robot_model.hpp"
#include "host/core/kinematics/self_hit.hpp"
#include "host/core/rig/host_rig.hpp"

namespace octoskin {

class RobotTracker {
  public:
    /// Refuses, by name, a body capsule on a link that the robot does not have.
    [[nodiscard]] static Result<RobotTracker, RobotModelFault> build(const HostRig& rig, RobotModel robot,
                                                                     const JointHistoryConfig& config);

    /// Takes joint samples in the order of their times.
    [[nodiscard]] Status<JointReason> add(const JointMeasurement& joints);

    /// The time continues from before the newest sample: clears all samples.
    void forget() noexcept { joints_.forget(); }

    /// True if the samples around `instant` have arrived or will never come: `at` then always gives the same
    /// result.
    [[nodiscard]] bool is_settled(HostTime instant) const noexcept { return joints_.is_settled(instant); }

    /// The robot at `instant`, or null if no samples surround it closely enough. Valid until the next call.
    /// About 2 us.
    [[nodiscard]] const RobotPose* at(HostTime instant);

    /// The newest gap between samples without a pose; empty if there was none.
    [[nodiscard]] const std::optional<JointGap>& newest_gap() const noexcept { return newest_gap_; }
    /// Number of such gaps in a row, including the newest, each within 3 s of the one before. A single gap is
    /// an interruption; many gaps show that the source is too slow.
    [[nodiscard]] std::uint64_t gaps_in_a_row() const noexcept { return gaps_in_a_row_; }

    /// Visits every stored sample, the oldest first.
    void for_each_sample(const std::function<void(const JointMeasurement&)>& visit) const;

    [[nodiscard]] const RobotModel& robot() const noexcept { return robot_; }

  private:
    void note_gap(const JointGap& gap);
    RobotTracker(RobotModel robot, RobotBody body, const JointHistoryConfig& config);

    RobotModel robot_;
    RobotBody body_;
    JointHistory joints_;
    std::optional<JointGap> newest_gap_;
    std::uint64_t gaps_in_a_row_ = 0;
    RobotPose pose_;
};

}  // namespace octoskin
