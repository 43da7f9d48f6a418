// What a node's state means for a user who commands it.
#pragma once

#include "common/wire/messages.hpp"

namespace octoskin {

/// Why a node in this state does not range, and the remedy. Null if it ranges, or would range after a command
/// to start.
[[nodiscard]] const char* obstacle(wire::NodeState state);

/// The message for a node that reports `commands_refused` in NODE_INFO.
inline constexpr const char* kCommandsRefused =
    "it refuses all commands: its rig has `refuses_commands: true` at this node; to command the node, remove "
    "that key from the rig and flash it";

}  // namespace octoskin
