// The wire as a DBC file, the format that CAN tools read (candump's companions, SavvyCAN, canmatrix,
// cantools).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/wire/messages.hpp"

namespace octoskin::dbc {

enum class NodeKind { sensor_board, joint_source };

struct Node {
    wire::NodeId node_id = 0;  ///< 1..62
    NodeKind kind = NodeKind::sensor_board;
    std::string name;  ///< a C identifier, at most 32 characters
};

/// The two sensor boards and the joint source of the rigs in hw/rigs/: what hw/octoskin.dbc is made of.
[[nodiscard]] std::vector<Node> shipped_nodes();

/// "9:board" or "10:joints": a sensor board or a joint source by its id, named "Board9" or "Joints10". Empty
/// for any other text, and for an id that no node may have.
[[nodiscard]] std::optional<Node> node_from_text(std::string_view text);

/// The DBC of a bus with the host and `nodes`, whose ids differ: one message for each identifier that may be
/// on it. Equal nodes give equal text.
[[nodiscard]] std::string dbc_text(const std::vector<Node>& nodes);

}  // namespace octoskin::dbc
