// Summary of each node at the end of a replay, for people.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/core/counters/loss.hpp"
#include "host/core/ingest/can_intake.hpp"

namespace octoskin {

struct NodeSummary {
    wire::NodeId node_id = 0;
    std::string name;
    /// Sum over all of its sensors; empty for a node without sensors.
    struct Readings {
        std::uint64_t received = 0;
        std::uint64_t lost = 0;  ///< sent and never received, by the node's own count (SensorRecord::lost)
        std::uint64_t gaps = 0;  ///< numbers missing between readings of known time
    };
    std::optional<Readings> readings;
    std::uint64_t clock_relocks = 0;
    NodeCondition verdict = NodeCondition::absent;
    bool has_time = true;  ///< false: no SYNC gave the host a time; then nothing of the node is usable
    std::optional<NodeMismatch> reason;    ///< the reported and the expected value
    std::optional<Loss> loss{};            ///< the node works, but over half of what it sends is lost
    std::vector<std::string> registers{};  ///< reported registers that read otherwise than written
};

/// For every node of the rig including the joint source, ordered by node id.
[[nodiscard]] std::vector<NodeSummary> summarise(const CanIntake& intake);

/// One line for each node, under a heading:
///
///     node                  readings      lost      gaps  re-locks  verdict
///       1 rear_rings            2218         0         0         0  usable
///
/// and below a node's line, one line for each register that reads otherwise than written.
[[nodiscard]] std::string to_text(std::span<const NodeSummary> nodes);

}  // namespace octoskin
