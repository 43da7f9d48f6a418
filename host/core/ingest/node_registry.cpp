#include "host/core/ingest/node_registry.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cstdio>
#include <utility>

#include "common/wire/crc.hpp"

namespace octoskin {
namespace {

using wire::NodeState;

/// A hold ends only when the host time is known and the last event is old enough. An event as far in the
/// future also ends it: the host's own clock then restarted.
bool is_held(bool is_set, std::optional<HostTime> since, std::optional<HostTime> now, Nanoseconds hold) {
    return is_set && !(since && now && std::chrono::abs(*now - *since) >= hold);
}

bool is_babbling(const NodeRecord& record, std::optional<HostTime> now) {
    return is_held(record.babbled.has_value(), record.babbled, now, NodeRegistry::kBabbleHold);
}

bool is_refused(const NodeRecord& record, std::optional<HostTime> now) {
    return is_held(record.is_other_version, record.other_version, now, NodeRegistry::kOtherVersionHold) ||
           is_held(record.is_in_conflict, record.conflict, now, NodeRegistry::kConflictHold) ||
           is_babbling(record, now);
}

bool is_suspect(const NodeRecord& record, std::optional<HostTime> now) {
    if (record.heartbeat->is_time_suspect) return true;
    return record.sends_joints &&
           is_held(record.is_suspected, record.suspected, now, NodeRegistry::kSuspectHold);
}

/// Call before the heartbeat is stored as the newest.
void note_suspicion(NodeRecord& record, const wire::Heartbeat& heartbeat, std::optional<HostTime> now) {
    if (heartbeat.is_time_suspect) {
        record.is_suspected = true;
        record.suspected = now;
    } else if (record.is_suspected && !record.suspected) {
        record.suspected = now;  // the hold starts once the host time is known
    } else {
        record.is_suspected = is_held(record.is_suspected, record.suspected, now, NodeRegistry::kSuspectHold);
    }
}

void note_second_board(NodeRecord& record, std::optional<HostTime> now) {
    record.is_in_conflict = true;
    record.conflict = now;
    record.pages = {};  // unknown which of the two boards sent them
    record.registers = {};
}

}  // namespace

bool NodeRecord::is_info_complete() const {
    return std::ranges::all_of(pages, [](const auto& entry) { return entry.has_value(); });
}

std::string NodeMismatch::text() const {
    constexpr std::uint32_t kCountsBelow = 256;  // counts and versions are below; hashes are above
    const bool is_count = found < kCountsBelow && expected < kCountsBelow;
    const auto written = [&](std::uint32_t value) {
        std::array<char, 16> text{};
        std::snprintf(text.data(), text.size(), is_count ? "%u" : "%08x", value);
        return std::string(text.data());
    };
    return std::string(what) + " " + written(found) + ", " + std::string(expected_by) + " " +
           written(expected);
}

std::optional<NodeMismatch> NodeRecord::mismatch() const noexcept {
    if (!has_block || !heartbeat) {
        return std::nullopt;
    }
    if (heartbeat->node_hash_low != (expected.node_hash & 0xFFFFU)) {
        return NodeMismatch{"low half of node_hash", heartbeat->node_hash_low, expected.node_hash & 0xFFFFU};
    }
    if (!is_info_complete()) {
        return std::nullopt;
    }
    const auto& identity = *page<wire::InfoIdentity>();
    if (identity.node_hash != expected.node_hash) {
        return NodeMismatch{"node_hash", identity.node_hash, expected.node_hash};
    }
    if (identity.sensor_count != expected.sensors.size()) {
        return NodeMismatch{"number of sensors", identity.sensor_count,
                            static_cast<std::uint32_t>(expected.sensors.size())};
    }
    const std::uint16_t uid_crc = crc16(page<wire::InfoUidHigh>()->uid, crc16(page<wire::InfoUidLow>()->uid));
    if (uid_crc != heartbeat->uid_crc) {
        return NodeMismatch{"checksum of the unique id in NODE_INFO", uid_crc, heartbeat->uid_crc};
    }
    return std::nullopt;
}

NodeRegistry::NodeRegistry(const HostRig& rig) {
    for (const HostNode& node : rig.nodes) {
        const auto source = rig.joint_source_of(node.node_id);
        add(node, source ? &rig.joint_sources[*source] : nullptr);
    }
    const bool is_one = rig.joint_sources.size() == 1;
    for (const HostJointSource& source : rig.joint_sources) {
        if (knows(source.node_id)) continue;
        add({.node_id = source.node_id,
             .name = is_one ? "joints" : fmt::format("joints of node {}", source.node_id),
             .node_hash = 0,
             .pinned_build_id = {},
             .sensors = {}},
            &source);
        records_.at(source.node_id).has_block = false;
    }
}

void NodeRegistry::add(const HostNode& node, const HostJointSource* joints) {
    records_[node.node_id].expected = node;
    records_[node.node_id].sends_joints = joints != nullptr;
    traffic_.emplace(node.node_id, NodeTraffic(node, joints != nullptr ? joints->rate_hz : 0.0));
}

bool NodeRegistry::is_lost(const NodeRecord& record, std::optional<HostTime> now) const {
    if (!now) return running_ - record.heard_running > kLostAfter;
    // Heard in the future: the host's own clock restarted.
    return !record.heard || std::chrono::abs(*now - *record.heard) > kLostAfter;
}

void NodeRegistry::on_time_known(HostTime now) {
    for (auto& [node, record] : records_) {
        if (std::exchange(record.is_heard_since, false)) {
            record.heard = now - (running_ - record.heard_running);
        }
    }
}

void NodeRegistry::on_frame(wire::NodeId node, std::optional<HostTime> now) {
    NodeRecord& record = records_.at(node);
    if (!traffic_.at(node).keeps_with_frame(now)) {
        record.babbled = now;
    } else if (!is_babbling(record, now)) {
        record.babbled.reset();
    }
}

void NodeRegistry::on_reading(wire::NodeId node, const wire::RangeReading& reading,
                              std::optional<HostTime> now) {
    if (!traffic_.at(node).keeps_with_reading(reading, now)) {
        note_second_board(records_.at(node), now);
    }
}

NodeRegistry::Life NodeRegistry::on_heartbeat(wire::NodeId node, const wire::Heartbeat& heartbeat,
                                              std::optional<HostTime> now) {
    NodeRecord& record = records_.at(node);
    const bool is_other_board = record.heartbeat && record.heartbeat->uid_crc != heartbeat.uid_crc;
    const bool is_back_at_start = record.heartbeat && record.heartbeat->state != NodeState::starting &&
                                  heartbeat.state == NodeState::starting;
    if (is_other_board && !is_lost(record, now)) {
        note_second_board(record, now);
    } else if (record.is_in_conflict && !record.conflict) {
        record.conflict = now;  // the hold starts once the host time is known
    }
    if (record.is_other_version && !record.other_version) {
        record.other_version = now;
    }
    if (is_back_at_start) {
        ++record.restarts;
        record.restarted = now;
    }
    if (is_other_board || is_back_at_start) {
        record.pages = {};
        record.registers = {};
    }
    note_suspicion(record, heartbeat, now);
    record.heartbeat = heartbeat;
    record.heard = now ? now : record.heard;
    record.is_heard_since = !now;
    record.heard_running = running_;
    return is_other_board || is_back_at_start ? Life::restarted : Life::goes_on;
}

void NodeRegistry::on_other_version(wire::NodeId node, std::uint8_t version, std::optional<HostTime> now) {
    NodeRecord& record = records_.at(node);
    record.version_reported = version;
    record.is_other_version = true;
    record.other_version = now;
    record.pages = {};
    record.registers = {};
}

bool NodeRegistry::on_info(wire::NodeId node, const wire::NodeInfo& info, std::optional<HostTime> now) {
    NodeRecord& record = records_.at(node);
    if (is_refused(record, now)) {
        return false;
    }
    record.is_in_conflict = false;
    record.is_other_version = false;
    record.pages[info.index()] = info;
    if (const auto* fault = std::get_if<wire::InfoFault>(&info)) record.registers.take(*fault);
    return true;
}

NodeCondition NodeRegistry::verdict(wire::NodeId node, std::optional<HostTime> now) const {
    const NodeRecord& record = records_.at(node);
    if (is_held(record.is_other_version, record.other_version, now, kOtherVersionHold)) {
        return NodeCondition::other_version;
    }
    if (is_held(record.is_in_conflict, record.conflict, now, kConflictHold)) {
        return NodeCondition::quarantined;
    }
    if (is_babbling(record, now)) {
        return NodeCondition::babbling;
    }
    if (!record.heartbeat) {
        return NodeCondition::absent;
    }
    if (is_lost(record, now)) {
        return NodeCondition::lost;
    }
    if (is_suspect(record, now)) {
        return NodeCondition::time_suspect;
    }
    if (!record.has_block) {
        return NodeCondition::usable;
    }
    if (record.mismatch()) {
        return NodeCondition::info_mismatch;
    }
    if (!record.is_info_complete()) {
        return NodeCondition::info_incomplete;
    }
    const auto& pinned = record.expected.pinned_build_id;
    return pinned && *pinned != record.page<wire::InfoBuild>()->build_id ? NodeCondition::build_refused
                                                                         : NodeCondition::usable;
}

std::optional<NodeMismatch> NodeRegistry::reason(wire::NodeId node, std::optional<HostTime> now) const {
    const NodeRecord& record = records_.at(node);
    const NodeCondition judged = verdict(node, now);
    if (judged == NodeCondition::other_version) {
        return NodeMismatch{"version", record.version_reported, wire::kProtocolVersion, "this host uses"};
    }
    if (judged == NodeCondition::build_refused) {
        return NodeMismatch{"build_id", record.page<wire::InfoBuild>()->build_id,
                            *record.expected.pinned_build_id, "the rig pins"};
    }
    return judged == NodeCondition::info_mismatch ? record.mismatch() : std::nullopt;
}

std::string NodeRegistry::describe(wire::NodeId node, std::optional<HostTime> now) const {
    const NodeCondition judged = verdict(node, now);
    const auto differs = reason(node, now);
    std::string why = differs ? differs->text() : std::string();
    if (judged == NodeCondition::info_mismatch) {
        why += ": flash it with this rig, `octoskin flash --rig RIG --node " + std::to_string(node) +
               " --elf IMAGE` (`firmware/flash` of octoskin's sources builds the image, too), or start "
               "octoskin-node with its new block, `octoskin rig RIG --node " +
               std::to_string(node) + " --block FILE`";
    }
    if (judged == NodeCondition::quarantined)
        why = "two boards send under this node id: take one off the bus";
    if (judged == NodeCondition::babbling) {
        why = "over " + std::to_string(traffic_.at(node).frames_max()) +
              " frames within a second, twice the rig's rate for it: refused until a second after it stays "
              "below that";
    }
    return "node " + std::to_string(node) + " '" + records_.at(node).expected.name +
           "': " + names_of(NodeCondition{})[static_cast<std::size_t>(judged)] +
           (why.empty() ? "" : " (" + why + ")");
}

}  // namespace octoskin
