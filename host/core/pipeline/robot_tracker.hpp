// Where the whole robot was at any instant: joint samples in, poses out.
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

    /// Joint samples in the order of their times.
    [[nodiscard]] Status<JointReason> add(const JointMeasurement& joints);

    /// Time goes on from before the newest sample: all of them are void.
    void forget() noexcept { joints_.forget(); }

    /// Whether the samples about `instant` are here, or will never come: `at` answers the same for ever.
    [[nodiscard]] bool is_settled(HostTime instant) const noexcept { return joints_.is_settled(instant); }

    /// The robot at `instant`, or null if no samples surround it closely enough. Valid until the next call.
    /// About 2 us.
    [[nodiscard]] const RobotPose* at(HostTime instant);

    /// The newest gap between samples that no pose could be found in; empty if there was none.
    [[nodiscard]] const std::optional<JointGap>& newest_gap() const noexcept { return newest_gap_; }
    /// How many such gaps, the newest included, came one within 3 s of the other: one is an interruption,
    /// many are a source that is too slow.
    [[nodiscard]] std::uint64_t gaps_in_a_row() const noexcept { return gaps_in_a_row_; }

    /// Every sample that is held, the oldest first.
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
