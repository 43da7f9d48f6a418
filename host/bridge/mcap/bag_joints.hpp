// The joint states of a bag as samples of the rig's joint sources.
#pragma once

#include <span>
#include <vector>

#include "host/apps/daemon/joint_line.hpp"
#include "host/bridge/mcap/bag_account.hpp"
#include "host/bridge/mcap/bag_log.hpp"
#include "host/bridge/received/joint_states.hpp"
#include "host/bridge/recorded/bus_clock.hpp"
#include "host/bridge/robot/robot_facts.hpp"
#include "host/core/kinematics/robot_model.hpp"
#include "host/io/mcap/mcap_reader.hpp"

namespace octoskin::bridge {

class BagJoints {
  public:
    /// `rig`: the sources that the topic gives are local ones. `limits`: of all joints of the rig.
    BagJoints(const HostRig& rig, std::span<const JointLimits> limits);

    /// Takes a message of JointState into `log`; counts it in `account`, except what only `finish` counts.
    void take(const mcap::Message& message, const BusClock& clock, bool uses_log_time, BagLog& log,
              TopicAccount& account);
    /// Counts what was rejected by the joints' own rules (JointStateCounts).
    void finish(TopicAccount& account) const;

    /// The joints that a message lacked, or the names of one that has none of the rig's; for a person.
    [[nodiscard]] const JointStates& states() const noexcept { return states_; }

  private:
    LineJoints line_;
    JointStates states_;
};

}  // namespace octoskin::bridge
