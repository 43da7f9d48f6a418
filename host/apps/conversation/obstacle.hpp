// What a heartbeat's state says to a person who wants something of the node.
#pragma once

#include "common/wire/messages.hpp"

namespace octoskin {

/// Why a node in this state does not range, and what to do; null if it ranges, or would if it were told to.
[[nodiscard]] const char* obstacle(wire::NodeState state);

/// What to do about a node that says `commands_refused` in NODE_INFO.
inline constexpr const char* kCommandsRefused =
    "it refuses all commands: its rig has `refuses_commands: true` at this node; take that key out of the "
    "rig "
    "and flash the node to command it";

}  // namespace octoskin
