// The frames of an endless log: the part between its two marks is repeated, with times and sequence numbers
// that continue.
#pragma once

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "common/wire/messages.hpp"
#include "host/core/pipeline/can_source.hpp"

namespace octoskin::test {

class EndlessLog {
  public:
    /// START and STOP must be in the log. Joints that are not at STOP where they are at START jump at the
    /// begin of each further round. `us_per_us`: the rate of each node's clock; that of another node is 1.
    EndlessLog(const std::vector<StampedFrame>& log, std::map<wire::NodeId, double> us_per_us);

    /// In the order of their time stamps, without the frames of the log's host and the nodes' answers to
    /// SYNC.
    [[nodiscard]] StampedFrame next();

  private:
    using Sensor = std::pair<wire::NodeId, std::uint8_t>;
    /// The number of each in a round.
    struct Counts {
        std::map<Sensor, unsigned> readings;
        std::map<wire::NodeId, unsigned> joint_samples;
        std::map<wire::NodeId, unsigned> reflexes;
    };
    void count(const wire::CanFrame& frame);
    [[nodiscard]] wire::CanFrame in_this_round(const wire::CanFrame& frame) const;

    std::vector<StampedFrame> frames_;
    std::map<wire::NodeId, double> us_per_us_;
    std::size_t round_begin_ = 0;  ///< index of the first frame after START
    std::int64_t round_ns_ = 0;    ///< from START to STOP
    Counts per_round_;
    std::size_t next_ = 0;
    unsigned round_ = 0;  ///< 0: unchanged from the log
};

}  // namespace octoskin::test
