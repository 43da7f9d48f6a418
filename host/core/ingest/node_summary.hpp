// How each node stands, for a person at the end of a replay.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/core/account/loss.hpp"
#include "host/core/ingest/can_intake.hpp"

namespace octoskin {

struct NodeSummary {
    wire::NodeId node_id = 0;
    std::string name;
    /// Of all its sensors together; empty for a node that has none.
    struct Readings {
        std::uint64_t received = 0;
        std::uint64_t lost = 0;  ///< sent and never come, by the node's own count (SensorRecord::lost)
        std::uint64_t gaps = 0;  ///< numbers left out between readings of known time
    };
    std::optional<Readings> readings;
    std::uint64_t clock_relocks = 0;
    NodeVerdict verdict = NodeVerdict::absent;
    bool has_time = true;  ///< false: no SYNC told the host any; then nothing of the node is usable
    std::optional<NodeMismatch> reason;    ///< what it told and what it should have told
    std::optional<Loss> loss{};            ///< it works, and over half of what it sends is lost all the same
    std::vector<std::string> registers{};  ///< what it told of registers that read otherwise than written
};

/// Of every node of the rig, the source of joints included, by node id.
[[nodiscard]] std::vector<NodeSummary> summarise(const CanIntake& intake);

/// One line each, under a heading:
///
///     node                  readings      lost      gaps  re-locks  verdict
///       1 rear_rings            2218         0         0         0  usable
///
/// and one for each register that reads otherwise than written, under its node's.
[[nodiscard]] std::string to_text(std::span<const NodeSummary> nodes);

}  // namespace octoskin
