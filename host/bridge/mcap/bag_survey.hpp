// What must be known of a bag before its messages are used: the clock of its bus, and the cameras.
#pragma once

#include <cstdint>
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
    /// Of the messages that one bus can hold, of which there are most: those before a clock was set are not.
    std::optional<WallTime> first = {};
    bool has_can = false;
    bool needs_can = false;  ///< the rig has sensors
    std::set<std::string> topics = {};
    /// The first description of each camera, by the topic of its images.
    std::map<std::string, ros::sensor_msgs::CameraInfo> infos = {};
};

/// Finds the first message of the longest run whose times lie within what a bus can hold.
class FirstOfMost {
  public:
    /// In the order of the log; is_log_time().
    void take(WallTime logged) {
        constexpr std::int64_t kSpan_ns = std::int64_t{8} * 365 * 24 * 3600 * 1'000'000'000;
        const bool continues =
            begin_ && logged.ns - begin_->ns <= kSpan_ns && begin_->ns - logged.ns <= kSpan_ns;
        if (!continues) {
            begin_ = logged;
            messages_ = 0;
        }
        if (++messages_ <= most_) return;
        most_ = messages_;
        first_ = begin_;
    }
    [[nodiscard]] const std::optional<WallTime>& first() const noexcept { return first_; }

  private:
    std::optional<WallTime> begin_;  ///< of the present run
    std::uint64_t messages_ = 0;
    std::uint64_t most_ = 0;
    std::optional<WallTime> first_;
};

/// Reads the whole bag once. Errors: those of McapReader::next.
[[nodiscard]] Result<BagSurvey, Error> survey_bag(mcap::McapReader& reader, const BagTopics& topics,
                                                  const HostRig& rig);

/// The frame of a message on a topic of the bus. The error is a reason for an account: "bad_frame" (an
/// identifier or a length that no frame has, or an error frame), and those of read_as().
[[nodiscard]] Result<wire::CanFrame, const char*> frame_of(const mcap::Message& message);

}  // namespace octoskin::bridge
