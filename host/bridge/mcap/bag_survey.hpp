// What must be known of a bag before its messages are used: the clock of its bus, and the cameras.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/result.hpp"
#include "common/wire/messages.hpp"
#include "host/bridge/recorded/bus_clock.hpp"
#include "host/core/rig/host_rig.hpp"
#include "host/io/mcap/mcap_reader.hpp"
#include "ros_messages.hpp"

namespace octoskin::bridge {

/// Topics of a bag; the types decide which of them are used.
struct BagTopics {
    std::string joint_states = "/joint_states";
    std::vector<std::string> can;     ///< of can_msgs/Frame or ros2_socketcan_msgs/FdFrame
    std::vector<std::string> images;  ///< of each camera of the rig, in its order
    [[nodiscard]] bool is_can(const std::string& topic) const;
};

struct BagSurvey {
    /// From the first SYNC with its FOLLOW_UP; empty: the bag has no bus, or one without its host.
    std::optional<BusClock> clock = {};
    std::set<wire::NodeId> joint_nodes = {};  ///< nodes that send joint states on the bus
    std::optional<WallTime> first = {};       ///< of all messages
    bool has_can = false;
    /// The first description of each camera, by the topic of its images.
    std::map<std::string, ros::sensor_msgs::CameraInfo> infos = {};
};

/// Reads the whole bag once. Errors: those of McapReader::next.
[[nodiscard]] Result<BagSurvey, Error> survey_bag(mcap::McapReader& reader, const BagTopics& topics,
                                                  const HostRig& rig);

/// The frame of a message on a topic of the bus. The error is a reason for an account: "bad_frame" (an
/// identifier or a length that no frame has, or an error frame), and those of read_as().
[[nodiscard]] Result<wire::CanFrame, const char*> frame_of(const mcap::Message& message);

}  // namespace octoskin::bridge
