// Texts about joint samples, the same in a replay and in the daemon.
#pragma once

#include <span>
#include <string>

#include "host/core/kinematics/joint_history.hpp"
#include "host/core/pipeline/joint_gate.hpp"

namespace octoskin {

/// "panda_joint1 is 4.1; its limits are -2.8973 to 2.8973". `names`: the rig's joints (must contain the
/// joint, asserted).
[[nodiscard]] std::string beyond_text(const JointBeyond& beyond, std::span<const std::string> names);

/// "Joint samples are 150 ms apart; at most 100 ms are bridged, and 50 ms to the nearer one."
[[nodiscard]] std::string gap_text(const JointGap& gap, const JointHistoryConfig& config = {});

}  // namespace octoskin
