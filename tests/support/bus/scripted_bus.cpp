#include "tests/support/bus/scripted_bus.hpp"

#include <algorithm>
#include <cmath>

#include "common/wire/codec.hpp"
#include "common/wire/crc.hpp"

namespace octoskin::test {
namespace {

std::int32_t microradians(std::span<const double> position_rad, std::size_t joint) {
    return joint < position_rad.size() ? static_cast<std::int32_t>(std::lround(1e6 * position_rad[joint]))
                                       : 0;
}

std::uint8_t next(std::uint8_t sequence, std::uint8_t count) {
    return static_cast<std::uint8_t>((sequence + 1) % count);
}

}  // namespace

HostTime host_at(double seconds) {
    return {std::llround(1e9 * seconds)};
}
WallTime wall_at(double seconds) {
    return {kWallOffsetNs + host_at(seconds).ns};
}

void ScriptedBus::set_clock(wire::NodeId node, std::uint32_t offset_us, double drift) {
    clocks_[node] = {offset_us, drift};
}

NodeTime ScriptedBus::node_time(wire::NodeId node, double at_s) const {
    const auto found = clocks_.find(node);
    const Clock clock = found == clocks_.end() ? Clock{} : found->second;
    const auto count = std::llround(1e6 * at_s * (1.0 + clock.drift));
    return {static_cast<std::uint32_t>(static_cast<std::uint64_t>(count)) + clock.offset_us};
}

void ScriptedBus::send(double at_s, const wire::CanFrame& frame) {
    frames_.push_back({wall_at(at_s), frame});
}

void ScriptedBus::send(double at_s, const wire::Message& message, wire::NodeId node) {
    send(at_s, wire::encode(message, node));
}

void ScriptedBus::exchange(double at_s, const std::vector<wire::NodeId>& nodes) {
    const std::uint8_t sequence = sync_sequence_;
    sync_sequence_ = next(sync_sequence_, wire::kSyncSequenceCount);
    send(at_s, wire::Sync{sequence}, wire::kHostId);
    send(at_s + 0.001, wire::FollowUp{sequence, static_cast<std::uint64_t>(host_at(at_s).ns / 1000)},
         wire::kHostId);
    for (const wire::NodeId node : nodes) {
        send(at_s + 0.002, wire::SyncReport{sequence, node_time(node, at_s)}, node);
    }
}

std::array<std::uint8_t, 12> ScriptedBus::uid_of(wire::NodeId node) {
    std::array<std::uint8_t, 12> uid{};
    uid.fill(node);
    return uid;
}

void ScriptedBus::info(double at_s, const HostNode& node, std::uint32_t build_id) {
    const auto uid = uid_of(node.node_id);
    wire::InfoUidLow low;
    wire::InfoUidHigh high;
    std::copy_n(uid.begin(), 6, low.uid.begin());
    std::copy_n(uid.begin() + 6, 6, high.uid.begin());
    const wire::InfoIdentity identity{.node_hash = node.node_hash,
                                      .sensor_count = static_cast<std::uint8_t>(node.sensors.size()),
                                      .board_type = 1};
    const std::array<wire::NodeInfo, wire::kInfoPages> pages = {
        low,
        high,
        identity,
        wire::InfoBuild{.build_id = build_id, .uptime_s = 1},
        wire::InfoCounters{},
        wire::InfoTraffic{},
        wire::InfoFault{}};
    for (const wire::NodeInfo& page : pages) {
        send(at_s, page, node.node_id);
    }
}

void ScriptedBus::heartbeat(double at_s, const HostNode& node) {
    send(at_s,
         wire::Heartbeat{.state = wire::NodeState::ranging,
                         .reset_cause = wire::ResetCause::power_on,
                         .is_rate_overridden = false,
                         .is_time_suspect = false,
                         .degraded_sensors = 0,
                         .uid_crc = crc16(uid_of(node.node_id)),
                         .node_hash_low = static_cast<std::uint16_t>(node.node_hash & 0xFFFFU)},
         node.node_id);
}

void ScriptedBus::health(double at_s, wire::NodeId node, std::uint8_t sensor,
                         std::uint8_t capture_bound_64us) {
    send(at_s,
         wire::SensorHealth{.sensor = sensor,
                            .state = wire::SensorState::ranging,
                            .fault = wire::SensorFault::none,
                            .sent = 0,
                            .capture_bound_64us = capture_bound_64us,
                            .rejected = 0,
                            .period_error_permille = 0},
         node);
}

void ScriptedBus::joints(double sampled_s, wire::NodeId node, std::span<const double> position_rad) {
    std::uint8_t& newest = joint_sequence_[node];
    const std::uint8_t sequence = newest;
    newest = next(newest, wire::kJointSequenceCount);
    for (std::uint8_t index = 0; index < 3; ++index) {
        const wire::JointPair pair{
            index,
            sequence,
            {microradians(position_rad, 2U * index), microradians(position_rad, 2U * index + 1U)}};
        send(sampled_s + 0.0001 * (1 + index), wire::JointState{pair}, node);
    }
    const wire::JointLast last{sequence, microradians(position_rad, 6),
                               wire::fd_residue(node_time(node, sampled_s))};
    send(sampled_s + 0.0004, wire::JointState{last}, node);
}

wire::RangeReading ScriptedBus::range(double captured_s, wire::NodeId node, wire::RangeReading reading,
                                      double delay_s) {
    std::uint8_t& sequence = range_sequence_[{node, reading.sensor}];
    reading.sequence = sequence;
    sequence = next(sequence, wire::kSequenceCount);
    reading.capture = wire::classical_residue(node_time(node, captured_s));
    send(captured_s + delay_s, wire::Range{reading}, node);
    return reading;
}

std::vector<StampedFrame> ScriptedBus::frames() const {
    std::vector<StampedFrame> sorted = frames_;
    std::ranges::stable_sort(sorted, {}, &StampedFrame::stamp);
    return sorted;
}

}  // namespace octoskin::test
