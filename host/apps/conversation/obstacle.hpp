// What a heartbeat's state says to a person who wants something of the node.
#pragma once

#include "common/wire/messages.hpp"

namespace octoskin {

/// Why a node in this state does not range, and what to do; null if it ranges, or would if it were told to.
[[nodiscard]] const char* obstacle(wire::NodeState state);

}  // namespace octoskin
