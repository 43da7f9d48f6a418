// Computes the pose of the whole robot at any instant from joint samples.
#pragma once

#include <array>
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

/// Each source of joint states has a history of its own: a pose has each joint at the pose's instant,
/// whatever the sources' rates. Joints of a source without samples around the instant are unknown
/// (`RobotPose::unknown`).
class RobotTracker {
  public:
    /// Refuses, by name, a body capsule on a link that the robot does not have. `robot` must move the joints
    /// of `rig.joint_names()` in that order (asserted: equal count).
    [[nodiscard]] static Result<RobotTracker, RobotModelFault> build(const HostRig& rig, RobotModel robot,
                                                                     const JointHistoryConfig& config);

    /// Takes joint samples in the order of their times. The source must be one of the rig (asserted).
    [[nodiscard]] Status<JointReason> add(const JointMeasurement& joints);

    /// The time continues from before the newest sample: clears all samples.
    void forget() noexcept;

    /// True if the samples around `instant` have arrived, or are not worth waiting for: a source counts as
    /// silent once another one is ahead of it by twice of what is bridged. Only if it sends again just after
    /// `instant` the result of `at` changes later.
    [[nodiscard]] bool is_settled(HostTime instant) const noexcept;

    /// The robot at `instant`, or null if no source has samples that surround it closely enough. Valid until
    /// the next call. About 2 us.
    [[nodiscard]] const RobotPose* at(HostTime instant);

    /// A source's newest gap between samples without a pose; empty if there was none.
    [[nodiscard]] const std::optional<JointGap>& newest_gap(std::size_t source) const {
        return sources_.at(source).newest_gap;
    }
    /// Number of such gaps in a row, including the newest, each within 3 s of the one before. A single gap is
    /// an interruption; many gaps show that the source is too slow.
    [[nodiscard]] std::uint64_t gaps_in_a_row(std::size_t source) const {
        return sources_.at(source).gaps_in_a_row;
    }
    /// Poses in which a joint was unknown while others were not, by joint.
    [[nodiscard]] std::span<const std::uint64_t> times_unknown() const noexcept {
        return std::span(times_unknown_).first(robot_.joint_count());
    }

    /// Time of the newest sample of a source; empty if it has none.
    [[nodiscard]] std::optional<HostTime> newest_sample(std::size_t source) const {
        return sources_.at(source).history.newest();
    }
    struct NewestPosition {
        std::vector<double> position;  ///< of all joints
        HostTime oldest;               ///< of the sources' newest samples
    };
    /// From the newest sample of each source; empty if one has none.
    [[nodiscard]] std::optional<NewestPosition> newest() const;

    /// Visits every stored sample, the oldest of a source first.
    void for_each_sample(const std::function<void(const JointMeasurement&)>& visit) const;

    [[nodiscard]] const RobotModel& robot() const noexcept { return robot_; }

  private:
    struct Source {
        std::size_t first = 0;  ///< of its joints, in all joint vectors
        std::size_t count = 0;
        JointHistory history;
        std::optional<JointGap> newest_gap = {};
        std::uint64_t gaps_in_a_row = 0;

        [[nodiscard]] JointSet joints() const noexcept;
        void note_gap(const JointGap& gap);
    };
    RobotTracker(const HostRig& rig, RobotModel robot, RobotBody body, const JointHistoryConfig& config);
    /// Fills in the positions at an instant; the result has the joints without one.
    [[nodiscard]] JointSet look_up(HostTime instant, std::span<double> position);
    void note_unknown(JointSet unknown);

    RobotModel robot_;
    RobotBody body_;
    JointHistoryConfig config_;
    std::vector<Source> sources_;
    std::array<std::uint64_t, kJointsMax> times_unknown_{};
    RobotPose pose_;
};

}  // namespace octoskin
