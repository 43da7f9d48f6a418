#include "hw/sim/experiment/joint_node.hpp"

#include <array>
#include <cmath>
#include <utility>

#include "common/wire/codec.hpp"
#include "common/wire/joint_frames.hpp"

namespace octoskin::sim {
namespace {

constexpr Microseconds kHeartbeatPeriod{100'000};

std::int32_t micro_radians(double radians) {
    return static_cast<std::int32_t>(std::lround(radians * 1e6));
}

}  // namespace

JointNode::JointNode(wire::NodeId node_id, double rate_hz, NodeClock clock, JointPositions positions)
    : node_id_(node_id),
      period_(static_cast<std::int64_t>(std::llround(1e6 / rate_hz))),
      clock_(clock),
      positions_(std::move(positions)) {}

std::vector<wire::CanFrame> JointNode::poll(SimTime now) {
    if (now >= next_sample_) {
        queue_sample(now);
        next_sample_.us += period_.count();
    }
    if (now >= next_heartbeat_) {
        const wire::Heartbeat heartbeat{.state = wire::NodeState::ranging,
                                        .reset_cause = wire::ResetCause::power_on};
        queue_.push_back(wire::encode(heartbeat, node_id_));
        next_heartbeat_.us += kHeartbeatPeriod.count();
    }
    return std::exchange(queue_, {});
}

void JointNode::queue_sample(SimTime now) {
    std::array<std::int32_t, wire::kJointsPerSample> position{};
    const std::vector<double> radians = positions_(now);
    for (std::size_t joint = 0; joint < radians.size() && joint < position.size(); ++joint) {
        position.at(joint) = micro_radians(radians[joint]);
    }
    sequence_ = static_cast<std::uint8_t>((sequence_ + 1U) % wire::kJointSequenceCount);
    const wire::TimeResidue sampled = wire::fd_residue(clock_.to_node(now));
    for (const wire::CanFrame& frame : wire::joint_frames(node_id_, sequence_, position, sampled))
        queue_.push_back(frame);
}

void JointNode::on_frame(const wire::CanFrame& frame, SimTime end) {
    const auto decoded = wire::decode(frame);
    if (!decoded) return;
    if (const auto* sync = std::get_if<wire::Sync>(&decoded->message)) {
        queue_.push_back(wire::encode(wire::SyncReport{sync->sequence, clock_.to_node(end)}, node_id_));
    }
}

}  // namespace octoskin::sim
