// The arm's controller as a node on the bus: joint states at a fixed rate, with time stamps of its own clock,
// which it reports on every SYNC like every node.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "common/wire/can_frame.hpp"
#include "common/wire/messages.hpp"
#include "hw/sim/clock.hpp"
#include "hw/sim/vl53l1x/scene.hpp"

namespace octoskin::sim {

/// Joint positions at an instant: at most 7, radians.
using JointPositions = std::function<std::vector<double>(SimTime)>;

class JointNode {
  public:
    JointNode(wire::NodeId node_id, double rate_hz, NodeClock clock, JointPositions positions);

    /// The frames to send at `now`: a sample's four when one is due, the heartbeat, a SYNC's report.
    [[nodiscard]] std::vector<wire::CanFrame> poll(SimTime now);
    void on_frame(const wire::CanFrame& frame, SimTime end);

  private:
    void queue_sample(SimTime now);

    wire::NodeId node_id_;
    Microseconds period_;
    NodeClock clock_;
    JointPositions positions_;
    SimTime next_sample_{};
    SimTime next_heartbeat_{};
    std::uint8_t sequence_ = 0;
    std::vector<wire::CanFrame> queue_;
};

}  // namespace octoskin::sim
