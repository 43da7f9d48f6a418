// sensor_msgs/JointState of several publishers as lines for the daemon's joint socket.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host/bridge/received/stamp.hpp"
#include "host/bridge/robot/robot_facts.hpp"
#include "ros_messages.hpp"

namespace octoskin::bridge {

struct JointStateCounts {
    std::uint64_t received = 0;
    std::uint64_t forwarded = 0;
    std::uint64_t other_joints = 0;   ///< none of the rig's joints from this machine
    std::uint64_t malformed = 0;      ///< not the encoding or the fields of JointState
    std::uint64_t wrong_size = 0;     ///< not one position for each name
    std::uint64_t not_finite = 0;     ///< a position of the rig's joints is NaN or infinite
    std::uint64_t repeated_name = 0;  ///< a joint twice
    std::uint64_t partial = 0;        ///< some joints of a source, but not all
    std::uint64_t ahead = 0;          ///< the stamp is ahead of this machine's clock
    std::uint64_t behind = 0;         ///< the stamp is too old
    std::uint64_t still = 0;          ///< the stamp is not newer than the one before
    std::uint64_t too_frequent = 0;   ///< above kRateMax_hz: thinned
    std::uint64_t second_sender = 0;  ///< another publisher sends the same joints
    std::uint64_t unsent = 0;         ///< of those forwarded: the daemon's joint socket did not take it
    /// Each message is counted under exactly one of them.
    [[nodiscard]] std::uint64_t sum() const noexcept {
        return forwarded + other_joints + malformed + wrong_size + not_finite + repeated_name + partial +
               ahead + behind + still + too_frequent + second_sender;
    }
};

class JointStates {
  public:
    static constexpr int kRateMax_hz = 1000;
    /// Publishers beyond these are counted as second senders.
    static constexpr std::size_t kPublishersMax = 32;
    /// Two publishers within this time are at work at once.
    static constexpr Nanoseconds kAtOnce{1'000'000'000};

    explicit JointStates(std::vector<JointSourceFacts> sources) : sources_(std::move(sources)) {}
    void change_sources(std::vector<JointSourceFacts> sources) { sources_ = std::move(sources); }

    /// The line for the joint socket ("TIME NAME=Q NAME=Q ..."), or empty: the message is counted.
    /// `publisher`: which writer of the topic sent it.
    [[nodiscard]] std::optional<std::string> take(const ros::sensor_msgs::JointState& message,
                                                  std::uint64_t publisher, const Arrival& arrival);
    struct Received {
        ros::sensor_msgs::JointState message;
        std::uint64_t publisher = 0;
        Arrival arrival;
    };
    /// The lines of several messages in the order of their arrival. Of messages without a stamp that waited
    /// together for this machine, only a publisher's newest has the time of its arrival.
    [[nodiscard]] std::vector<std::string> take(const std::vector<Received>& messages);
    void note_malformed() noexcept {
        ++counts_.received;
        ++counts_.malformed;
    }

    [[nodiscard]] const JointStateCounts& counts() const noexcept { return counts_; }
    /// The joints that the newest partial message lacked, for a message to a person.
    [[nodiscard]] const std::string& missing() const noexcept { return missing_; }
    /// The names of the newest message that has none of the rig's joints.
    [[nodiscard]] const std::string& other_names() const noexcept { return other_names_; }
    void note_unsent() noexcept { ++counts_.unsent; }
    /// True if the daemon takes joint states from this machine.
    [[nodiscard]] bool has_local_source() const noexcept;
    /// Of the sources from this machine, for a message to a person.
    [[nodiscard]] std::string local_joints() const;
    /// How far the newest refused stamp is behind this machine's clock; negative: ahead.
    [[nodiscard]] Nanoseconds stamp_age() const noexcept { return stamp_age_; }

  private:
    struct Publisher {
        WallTime stamp;                     ///< the newest one
        std::optional<HostTime> forwarded;  ///< the time of its newest sample that was
        std::vector<HostTime> sent;         ///< by source: its newest message with that source's joints
    };
    using Positions = std::map<std::string, double, std::less<>>;
    static constexpr Nanoseconds kPeriodMin{1'000'000'000 / kRateMax_hz * 9 / 10};
    [[nodiscard]] bool takes_names(const ros::sensor_msgs::JointState& message, Positions& positions);
    /// The indices of the sources that the message has whole; empty and counted if there is none, or a part.
    [[nodiscard]] std::vector<std::size_t> whole_sources(const Positions& positions);
    [[nodiscard]] bool has_rival(std::uint64_t publisher, const std::vector<std::size_t>& sources,
                                 HostTime now);

    std::vector<JointSourceFacts> sources_;
    JointStateCounts counts_;
    std::map<std::uint64_t, Publisher> publishers_;
    std::string missing_;
    std::string other_names_;
    Nanoseconds stamp_age_{0};
};

}  // namespace octoskin::bridge
