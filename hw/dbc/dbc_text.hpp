// The protocol as a DBC file, the format of CAN tools (SavvyCAN, canmatrix, cantools, and tools for candump's
// logs).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/wire/frame_type.hpp"
#include "common/wire/messages.hpp"

namespace octoskin::dbc {

enum class NodeKind { sensor_board, joint_source };

/// False for what the host sends.
[[nodiscard]] bool is_sent_by(NodeKind kind, wire::FrameType type) noexcept;

struct Node {
    wire::NodeId node_id = 0;  ///< 1..62
    NodeKind kind = NodeKind::sensor_board;
    std::string name;  ///< a C identifier, at most 32 characters
};

/// The two sensor boards and the joint source of the rigs in hw/rigs/: the nodes of hw/octoskin.dbc.
[[nodiscard]] std::vector<Node> shipped_nodes();

/// "9:board" or "10:joints": a sensor board or a joint source with its id, named "Board9" or "Joints10".
/// Empty for any other text, and for an id outside 1..62.
[[nodiscard]] std::optional<Node> node_from_text(std::string_view text);

/// The DBC of a bus with the host and `nodes`, whose ids must differ: one message per identifier. Equal nodes
/// give equal text.
[[nodiscard]] std::string dbc_text(const std::vector<Node>& nodes);

}  // namespace octoskin::dbc
