// Texts about joint samples, the same in a replay and in the daemon.
#pragma once

#include <span>
#include <string>

#include "host/core/kinematics/joint_history.hpp"
#include "host/core/pipeline/joint_gate.hpp"

namespace octoskin {

/// "panda_joint1 is 4.1; its limits are -2.8973 to 2.8973". `names`: the joints of the sample's source (must
/// contain the joint, asserted).
[[nodiscard]] std::string beyond_text(const JointBeyond& beyond, std::span<const std::string> names);

/// "Joint samples are 150 ms apart; at most 100 ms are bridged, and 50 ms to the nearer one."
[[nodiscard]] std::string gap_text(const JointGap& gap, const JointHistoryConfig& config = {});

/// " No position was known of finger (12 times).": the joints that were unknown most often; empty if all were
/// as often. `times`: RobotTracker::times_unknown.
[[nodiscard]] std::string unknown_text(std::span<const std::uint64_t> times,
                                       std::span<const std::string> names);

}  // namespace octoskin
